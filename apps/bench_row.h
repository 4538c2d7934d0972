// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What is written down of one run, as `mneme bench` and `mneme demo` do it.
#pragma once

#include "mneme/pipeline.h"
#include "mneme/report.h"

namespace mneme::app {

/// The row of one call of solve() with `settings`; its path is checked again by `checker` without
/// trusting anything that helped to find it. A path that came after the time limit is none.
[[nodiscard]] BenchmarkRow make_row(const Problem& problem, const SolveSettings& settings,
                                    const SolveResult& result, const CollisionChecker& checker);

}  // namespace mneme::app
