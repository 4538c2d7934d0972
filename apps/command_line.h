// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The command line as data: the help of all subcommands, for the manual page and the completions
/// of shells, and what the user may have meant by a word that is no subcommand or flag.
#pragma once

#include <CLI/CLI.hpp>

#include <optional>
#include <string>
#include <vector>

namespace mneme::app {

struct FlagDescription {
  std::vector<std::string> names;  ///< "-o", "--output"; of an argument its name alone
  std::string value;               ///< what stands for its value in the help; empty for a switch
  std::string sentence;
};

struct CommandDescription {
  std::string words;  ///< "db info"; empty for the program itself
  std::string sentence;
  std::string footer;
  std::vector<FlagDescription> arguments;
  std::vector<FlagDescription> flags;
  std::vector<std::pair<std::string, std::string>> subcommands;  ///< name and sentence
};

/// The program and all its subcommands, each before those below it.
[[nodiscard]] std::vector<CommandDescription> describe_commands(const CLI::App& program);

struct Complaint {
  const CLI::App* command;  ///< whose help tells what is right
  std::string message;
};

/// The complaint about the first of the leading `words` that is no subcommand where one is
/// expected, if there is one.
[[nodiscard]] std::optional<Complaint> unknown_command(const CLI::App& program,
                                                       const std::vector<std::string>& words);

/// The complaint about the first of `words` that is a flag with an equals sign and nothing after
/// it, if there is one: the next word would be taken for its value.
[[nodiscard]] std::optional<Complaint> missing_value(const CLI::App& program,
                                                     const std::vector<std::string>& words);

/// What CLI11 says of a number of values, in the words of this program where it is a value that is
/// missing.
[[nodiscard]] std::string describe_mismatch(const std::string& message);

/// The complaint about what `command` was given but does not take, if there is such a thing.
[[nodiscard]] std::optional<std::string> unexpected_argument(const CLI::App& command);

}  // namespace mneme::app
