// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme cell build, and what is printed of a cell.
#pragma once

#include "mneme/cell.h"

#include "commands.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <string>

namespace mneme::app {

/// Adds `cell build`.
void add_cell_build(CLI::App& group, Action& action);

/// Prints the boxes of a cell in the file `path`, and which shares of the region are proven.
void print_built(const Cell& cell, const std::string& path);
/// The same as JSON.
[[nodiscard]] nlohmann::ordered_json describe_cell(const Cell& cell);

}  // namespace mneme::app
