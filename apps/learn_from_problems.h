// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Learning from problems that are solved for the purpose: `mneme learn --problems`.
#pragma once

#include "mneme/learning.h"
#include "mneme/problem.h"

#include <span>
#include <string>
#include <vector>

namespace mneme::app {

struct ProblemLesson {
  std::vector<std::string> problems;  ///< files, single problems and directories
  std::string part;                   ///< see take_part()
  int paths = 5;                      ///< per problem
  double timeout_s = 10;              ///< per path
  std::uint64_t seed = 1;
};

/// The problems of a lesson, all of one robot.
[[nodiscard]] Result<std::vector<Problem>> load_lesson(const ProblemLesson& lesson,
                                                       const ProblemOptions& overrides);

struct RepeatedPlan {
  std::vector<Path> paths;
  std::string message;  ///< why the last run without a path has none
};

/// Solves the problem `lesson.paths` times with uniform samples; an interrupt ends it.
[[nodiscard]] Result<RepeatedPlan> solve_repeatedly(const Problem& problem,
                                                    const ProblemLesson& lesson);

struct ProblemLessonSummary {
  int learned = 0;   ///< problems
  int skipped = 0;   ///< learned before with the same seed
  int unsolved = 0;  ///< problems without a path
  std::int64_t rows = 0;
  std::int64_t components = 0;
  bool is_cancelled = false;
  double time_s = 0;
};

/// Solves each problem several times with uniform samples and inserts what its primitives learn
/// from the paths, problem by problem, so that an interrupted lesson goes on where it was.
[[nodiscard]] Result<ProblemLessonSummary> learn_from_problems(std::span<const Problem> problems,
                                                               const ProblemLesson& lesson,
                                                               const DecomposeSettings& decompose,
                                                               Database& database);

}  // namespace mneme::app
