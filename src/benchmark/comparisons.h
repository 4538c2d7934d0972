// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Which series of a panel are compared with which.
#pragma once

#include <string>
#include <vector>

#include "benchmark/panels.h"
#include "mneme/benchmark.h"

namespace mneme::internal {

struct Comparison {
  std::string kind;  ///< "sampler", "setting" or "planner": what differs
  const Series* other = nullptr;
  const Series* reference = nullptr;
  PairedRatio ratio;
};

/// Each sampler with `baseline` under the same planner and setting, or under another setting if
/// that one has no baseline; each setting with the first one; mneme's planners with OMPL's of the
/// same name. Comparisons without pairs are left out.
[[nodiscard]] std::vector<Comparison> compare_series(const Panel& panel,
                                                     const std::string& baseline);

/// "≥ 27.1 (4.80 to 33.0)"; "open" if both sides failed, so that the ratio says nothing.
[[nodiscard]] std::string format_ratio(const TimeRatio& ratio);
/// "rrt_connect, gl, paper"
[[nodiscard]] std::string series_name(const Series& series);

}  // namespace mneme::internal
