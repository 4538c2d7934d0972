// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Runs as OMPL's benchmark tools see them: experiments of planners with properties.
#pragma once

#include "mneme/benchmark.h"

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

struct OmplProperty {
  std::string_view name;  ///< words between blanks; columns have '_' instead
  std::string_view type;
};
inline constexpr std::array<OmplProperty, 16> kOmplProperties = {{{"solved", "BOOLEAN"},
                                                                  {"correct solution", "BOOLEAN"},
                                                                  {"time", "REAL"},
                                                                  {"simplification time", "REAL"},
                                                                  {"solution length", "REAL"},
                                                                  {"status", "ENUM"},
                                                                  {"seed", "INTEGER"},
                                                                  {"iterations", "INTEGER"},
                                                                  {"graph states", "INTEGER"},
                                                                  {"states checked", "INTEGER"},
                                                                  {"motions checked", "INTEGER"},
                                                                  {"total time", "REAL"},
                                                                  {"retrieval time", "REAL"},
                                                                  {"learning time", "REAL"},
                                                                  {"verification time", "REAL"},
                                                                  {"components", "INTEGER"}}};

/// The names of ompl::base::PlannerStatus, in order.
inline constexpr std::array<std::string_view, 9> kOmplStatuses = {
    "Unknown status",         "Invalid start", "Invalid goal",
    "Unrecognized goal type", "Timeout",       "Approximate solution",
    "Exact solution",         "Crash",         "Abort"};

/// What the tools call a configuration of a planner.
struct OmplPlanner {
  std::string name;
  std::vector<std::string> settings;           ///< "NAME = VALUE"
  std::vector<std::vector<std::string>> runs;  ///< one value per property; empty for none
};

struct OmplExperiment {
  std::string name;
  std::string host;
  std::string machine;
  std::string date;  ///< "2026-01-31 12:00:00"
  std::string setup;
  std::string seed;
  double timeout_s = 0;  ///< the longest
  double total_time_s = 0;
  std::size_t run_count = 0;  ///< of the planner that has most
  std::vector<OmplPlanner> planners;
};

/// One experiment per set and problem.
[[nodiscard]] std::vector<OmplExperiment> to_experiments(std::span<const BenchmarkRow> rows);

}  // namespace mneme::internal
