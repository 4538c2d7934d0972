// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// `mneme bench report` and `mneme bench export`: what becomes of runs that are done.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "mneme/benchmark.h"

#include "commands.h"

namespace mneme::app {

/// Adds both subcommands to `bench`.
void add_bench_report(CLI::App& bench, Action& action);

/// Writes the page to `path` and its figures beside it, as PAGE_FIGURE.svg.
[[nodiscard]] Result<void> write_report(const std::string& path, const BenchmarkReport& report);
/// Writes a log per problem into `directory`, which is made if it is missing.
[[nodiscard]] Result<void> write_ompl_logs(const std::string& directory,
                                           std::span<const BenchmarkRow> rows);
/// The memories that a suite wrote down; none if there is no such file.
[[nodiscard]] Result<std::vector<MemoryRow>> read_memories(const std::string& path);

}  // namespace mneme::app
