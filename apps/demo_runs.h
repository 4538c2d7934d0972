// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The runs that the demo compares: planners with and without memory, over seeds.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mneme/pipeline.h"
#include "mneme/report.h"

namespace mneme::app {

/// One planner with one sampler on one problem.
struct DemoCell {
  const Problem* problem = nullptr;
  std::string planner;
  std::string sampler;
  double timeout_s = 0;
};

/// The cells of the demo in the order of its table: problems, then planners, then samplers.
[[nodiscard]] std::vector<DemoCell> demo_cells(std::span<const Problem> problems,
                                               std::optional<double> timeout_s);

struct DemoOutcome {
  std::vector<BenchmarkRow> rows;
  std::optional<SolveResult> first_solved;  ///< what a picture of the cell shows
  bool is_interrupted = false;
};

/// Runs `cell` with the seeds 1 to `seed_count`, and checks every path again. A cell whose first
/// kHopelessRuns runs all fail is not run further. `on_run` is called after each run.
[[nodiscard]] Result<DemoOutcome> run_cell(const DemoCell& cell, Database& database, int seed_count,
                                           const std::function<void()>& on_run);
inline constexpr int kHopelessRuns = 5;

}  // namespace mneme::app
