// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The loop of `mneme bench run`: problems x planners x samplers x seeds in one process.
#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "mneme/pipeline.h"
#include "mneme/report.h"

namespace mneme::app {

struct LoadedProblem {
  std::string set;
  Problem problem;
};

struct BenchPlan {
  std::vector<LoadedProblem> problems;
  std::vector<std::string> planners;
  std::vector<std::string> samplers;
  int seed_count = 1;
  SolveSettings settings;  ///< `settings.plan.seed` is the first seed
  /// Memories by the hash of the robot; the sampler "gl" draws from that of the problem's robot.
  std::map<std::string, Database> memories;

  [[nodiscard]] std::size_t run_count() const {
    return problems.size() * planners.size() * samplers.size() *
           static_cast<std::size_t>(seed_count);
  }
};

/// Receives the row of each run as soon as it is done. An error ends the benchmark.
using OnRow = std::function<Result<void>(const BenchmarkRow& row)>;

/// Runs what `done` does not hold yet, all problems with one seed before the next seed. True if it
/// was not interrupted.
[[nodiscard]] Result<bool> run_bench(BenchPlan& plan, std::span<const BenchmarkRow> done,
                                     const OnRow& on_row);

}  // namespace mneme::app
