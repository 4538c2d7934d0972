// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "command_line.h"

#include <utility>

namespace mneme::app {
namespace {

/// Subcommands that are shown: a hidden one has no group.
std::vector<const CLI::App*> subcommands_of(const CLI::App& command) {
  return command.get_subcommands([](const CLI::App* subcommand) {
    return !subcommand->get_name().empty() && !subcommand->get_group().empty();
  });
}

FlagDescription describe(const CLI::Option& option) {
  FlagDescription flag;
  for (const std::string& name : option.get_snames()) flag.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) flag.names.push_back("--" + name);
  if (flag.names.empty()) flag.names.push_back(option.get_name(true));
  flag.value = option.get_items_expected_max() > 0 ? option.get_type_name() : "";
  flag.sentence = option.get_description();
  return flag;
}

void append(const CLI::App& command, const std::string& words,
            std::vector<CommandDescription>& all) {
  CommandDescription description;
  description.words = words;
  description.sentence = command.get_description();
  description.footer = command.get_footer();
  for (const CLI::Option* option : command.get_options()) {
    (option->get_positional() ? description.arguments : description.flags)
        .push_back(describe(*option));
  }
  for (const CLI::App* subcommand : subcommands_of(command)) {
    description.subcommands.emplace_back(subcommand->get_name(), subcommand->get_description());
  }
  all.push_back(std::move(description));
  for (const CLI::App* subcommand : subcommands_of(command)) {
    append(*subcommand, (words.empty() ? "" : words + " ") + subcommand->get_name(), all);
  }
}

}  // namespace

std::vector<CommandDescription> describe_commands(const CLI::App& program) {
  std::vector<CommandDescription> all;
  append(program, "", all);
  return all;
}

}  // namespace mneme::app
