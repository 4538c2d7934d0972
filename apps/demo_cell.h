// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The first part of the demo: an arm in space repeats the tasks of a cell, with and without a
/// memory.
#pragma once

#include "mneme/experience.h"
#include "mneme/path.h"
#include "mneme/problem.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace mneme::app {

/// A repetition of a task, planned and replayed.
struct RepeatedTask {
  double planned_s = 0;           ///< solve() without memory, proof included
  double replayed_s = 0;          ///< solve() with the memory, proof included
  double planned_deviation = 0;   ///< from the task's first path: path_deviation(), radians
  double replayed_deviation = 0;  ///< deviation of the replayed path, radians
  bool is_replayed = false;       ///< false: the memory did not help, and the task was planned
};

struct CellRuns {
  int tasks = 0;
  std::vector<RepeatedTask> repeats;
  int unsolved = 0;  ///< repetitions without a path, planned or replayed; not among `repeats`
  int wrong = 0;     ///< paths that failed the exact check
  Path longest;      ///< longest stored path
  std::optional<Problem> shown;  ///< task of the longest stored path
};

/// Makes `tasks` tasks of the cell of `base`, each with another goal, plans each once into
/// `memory`, then plans and replays each `repeats` times with obstacles and goals moved by up to 1
/// cm. Stops at an interrupt. Errors: as repeat() and solve().
[[nodiscard]] Result<CellRuns> run_cell(const Problem& base, int tasks, int repeats,
                                        std::uint64_t seed, Database& memory);

/// Largest L2 joint distance between two paths at equal fractions of their lengths, radians.
[[nodiscard]] double path_deviation(const Robot& robot, const Path& a, const Path& b);

/// The result as sentences: gain, no gain or loss, with medians. Empty without repetitions.
[[nodiscard]] std::string describe_cell(const std::string& robot, const CellRuns& runs);

}  // namespace mneme::app
