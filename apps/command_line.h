// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The command line as data: the help of all subcommands, for the manual page and the completions
/// of shells.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <utility>
#include <vector>

namespace mneme::app {

struct FlagDescription {
  std::vector<std::string> names;  ///< "-o", "--output"; of an argument its name alone
  std::string value;               ///< placeholder of the flag's value in the help; empty for a
                                   ///< switch
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

}  // namespace mneme::app
