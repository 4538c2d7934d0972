// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The loop of `mneme bench run`: problems x settings x planners x samplers x seeds in one process.
#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "mneme/benchmark.h"

namespace mneme::app {

struct LoadedProblem {
  std::string set;
  Problem problem;
};

/// What is run on each problem with each seed.
struct BenchCase {
  std::string setting;
  std::string memory;             ///< that the sampler gl draws from
  std::vector<std::string> sets;  ///< of problems; empty for all
  SolveSettings settings;         ///< with planner and sampler
  bool is_ompl_as_in_paper = false;
  std::string ompl_experience;  ///< file of what Lightning or Thunder knows; may be empty
  std::string description;      ///< of the settings, for the rows
};

struct BenchPlan {
  std::vector<LoadedProblem> problems;
  std::vector<BenchCase> cases;
  int seed_count = 1;
  std::uint64_t first_seed = 1;
  int jobs = 1;
  /// By the name of the memory and the hash of the robot.
  std::map<std::pair<std::string, std::string>, Database> memories;

  [[nodiscard]] std::size_t run_count() const;
};

/// True if runs change the memory, so that later ones depend on earlier ones.
[[nodiscard]] bool learns_while_planning(const SolveSettings& settings);

/// Appends a case for each of `planners` with each of `samplers`.
void append_cases(const BenchCase& setting, const std::vector<std::string>& planners,
                  const std::vector<std::string>& samplers, std::vector<BenchCase>& cases);

/// An error if `rows` were run with other settings or limits than `plan` has under the same name.
[[nodiscard]] Result<void> check_same_settings(const BenchPlan& plan,
                                               std::span<const BenchmarkRow> rows);

/// Puts rows into the order in which one job runs the plan; those of other plans go last.
void sort_rows(const BenchPlan& plan, std::vector<BenchmarkRow>& rows);

/// Receives the row of each run as soon as it is done, one at a time. An error ends the benchmark.
using OnRow = std::function<Result<void>(const BenchmarkRow& row)>;

/// Runs what `done` does not hold yet, all problems with one seed before the next seed and
/// every other seed with the cases in reverse, in `plan.jobs` threads. True if it was not
/// interrupted.
[[nodiscard]] Result<bool> run_bench(BenchPlan& plan, std::span<const BenchmarkRow> done,
                                     const OnRow& on_row);

}  // namespace mneme::app
