// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The tables of a benchmark report, as HTML.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "benchmark/comparisons.h"
#include "benchmark/panels.h"

namespace mneme::internal {

/// One line per series: solved/valid/total, bad paths, p50, p95, p99, max. The attribute
/// `data-seconds` of each time has all its digits.
[[nodiscard]] std::string time_table(const Panel& panel);
/// One line per comparison; empty if there are none. Numbers with all digits are in `data-ratio`.
[[nodiscard]] std::string ratio_table(const std::vector<Comparison>& comparisons);
[[nodiscard]] std::string memory_table(std::span<const MemoryRow> memories);
/// What the settings' names stand for.
[[nodiscard]] std::string settings_table(std::span<const BenchmarkRow> rows);

}  // namespace mneme::internal
