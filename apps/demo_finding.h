// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What a demo has found, in one sentence.
#pragma once

#include "mneme/benchmark.h"

#include <span>
#include <string>

namespace mneme::app {

/// How long each planner took on the problems whose names begin with "threaded", from memory and
/// uniformly: medians, in which a run without a path is longer than any other. Empty without such
/// problems.
[[nodiscard]] std::string describe_finding(std::span<const BenchmarkRow> rows);

}  // namespace mneme::app
