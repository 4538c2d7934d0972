// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What the user may have meant by a word that is no subcommand or flag.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace mneme::app {

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

/// The complaint about what `command` was given but does not take, if there is such a thing.
[[nodiscard]] std::optional<std::string> unexpected_argument(const CLI::App& command);

}  // namespace mneme::app
