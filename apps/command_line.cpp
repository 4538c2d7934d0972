// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "command_line.h"

#include "mneme/base.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

namespace mneme::app {
namespace {

/// Those for people: a hidden one has no group.
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

std::vector<std::string> subcommand_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::App* subcommand : command.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(subcommand->get_name());
  }
  return names;
}

std::vector<std::string> flag_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

}  // namespace

std::vector<CommandDescription> describe_commands(const CLI::App& program) {
  std::vector<CommandDescription> all;
  append(program, "", all);
  return all;
}

std::optional<Complaint> unknown_command(const CLI::App& program,
                                         const std::vector<std::string>& words) {
  const CLI::App* command = &program;
  for (const std::string& word : words) {
    const std::vector<std::string> names = subcommand_names(*command);
    if (names.empty() || word.starts_with('-')) return std::nullopt;
    if (std::find(names.begin(), names.end(), word) == names.end()) {
      const std::string close = did_you_mean(word, names);
      std::vector<std::string> shown;
      for (const CLI::App* each : subcommands_of(*command)) shown.push_back(each->get_name());
      return Complaint{command, fmt::format("unknown subcommand '{}'{}", word,
                                            close.empty() ? fmt::format("; expected one of: {}",
                                                                        fmt::join(shown, ", "))
                                                          : close)};
    }
    command = command->get_subcommand(word);
  }
  return std::nullopt;
}

std::optional<Complaint> missing_value(const CLI::App& program,
                                       const std::vector<std::string>& words) {
  const CLI::App* command = &program;
  for (const std::string& word : words) {
    if (word == "--") return std::nullopt;
    if (word.starts_with("--") && word.find('=') == word.size() - 1) {
      return Complaint{
          command, fmt::format("{}: expected a value after '='", word.substr(0, word.size() - 1))};
    }
    const std::vector<std::string> names = subcommand_names(*command);
    const bool is_command = std::find(names.begin(), names.end(), word) != names.end();
    if (is_command) command = command->get_subcommand(word);
  }
  return std::nullopt;
}

std::string describe_mismatch(const std::string& message) {
  constexpr std::string_view kRequired = ": 1 required ", kMissing = " missing";
  const std::size_t begin = message.find(kRequired);
  if (begin == std::string::npos || !message.ends_with(kMissing)) return message;
  const std::size_t type = begin + kRequired.size();
  return fmt::format("{}: expected a value: {}", message.substr(0, begin),
                     message.substr(type, message.size() - kMissing.size() - type));
}

std::optional<std::string> unexpected_argument(const CLI::App& command) {
  const std::vector<std::string> words = command.remaining();
  if (words.empty()) return std::nullopt;
  // An unknown flag leaves its value over too: the flag is what to complain about.
  auto word = std::find_if(words.begin(), words.end(),
                           [](const std::string& w) { return w.starts_with('-'); });
  if (word == words.end()) word = words.begin();
  const std::string flag = word->substr(0, word->find('='));
  return fmt::format("unexpected argument '{}'{}", *word,
                     flag.starts_with("--") ? did_you_mean(flag, flag_names(command)) : "");
}

}  // namespace mneme::app
