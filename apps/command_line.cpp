// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "command_line.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>
#include <string_view>
#include <utility>

namespace mneme::app {
namespace {

std::vector<const CLI::App*> subcommands_of(const CLI::App& command) {
  return command.get_subcommands(
      [](const CLI::App* subcommand) { return !subcommand->get_name().empty(); });
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

/// Levenshtein's distance: insertions, deletions and replacements of characters.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

/// "; did you mean ...?" if one of `names` is close to `word`.
std::string suggestion(std::string_view word, const std::vector<std::string>& names) {
  const auto is_closer = [&](const std::string& a, const std::string& b) {
    return edit_distance(word, a) < edit_distance(word, b);
  };
  const auto nearest = std::min_element(names.begin(), names.end(), is_closer);
  if (nearest == names.end() || edit_distance(word, *nearest) > 1 + word.size() / 3) return "";
  return fmt::format("; did you mean '{}'?", *nearest);
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
      const std::string close = suggestion(word, names);
      return Complaint{command, fmt::format("unknown subcommand '{}'{}", word,
                                            close.empty() ? fmt::format("; expected one of: {}",
                                                                        fmt::join(names, ", "))
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

std::optional<std::string> unexpected_argument(const CLI::App& command) {
  const std::vector<std::string> words = command.remaining();
  if (words.empty()) return std::nullopt;
  // An unknown flag leaves its value over too: the flag is what to complain about.
  auto word = std::find_if(words.begin(), words.end(),
                           [](const std::string& w) { return w.starts_with('-'); });
  if (word == words.end()) word = words.begin();
  const std::string flag = word->substr(0, word->find('='));
  return fmt::format("unexpected argument '{}'{}", *word,
                     flag.starts_with("--") ? suggestion(flag, flag_names(command)) : "");
}

}  // namespace mneme::app
