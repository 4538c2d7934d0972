// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The findings of the demo as sentences.
#pragma once

#include "mneme/benchmark.h"

#include <span>
#include <string>
#include <vector>

namespace mneme::app {

/// Of an even number of values the upper one. Precondition: there is a value.
[[nodiscard]] double median(std::vector<double> values);
/// Compares two medians in milliseconds, without and with memory: a gain, no gain or a loss.
[[nodiscard]] std::string compare_times(double without_ms, double with_ms);

/// A sentence about each planner on the problems whose names begin with "threaded": medians with
/// and without memory, in which a run without a path is longer than any other. Empty without such
/// problems.
[[nodiscard]] std::string describe_finding(std::span<const BenchmarkRow> rows);

}  // namespace mneme::app
