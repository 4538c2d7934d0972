// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Motions as a planner asks for them, recorded on problems.
#pragma once

#include "mneme/problem.h"

#include <string>
#include <vector>

namespace mneme::bench {

/// Straight motions in one problem; rows of joint_count values.
struct Motions {
  std::vector<float> from, to;
};

/// The motions of one problem, as a checker with the default settings judges them.
struct Edges {
  Problem problem;
  Motions valid, invalid;
};

/// Problems of files, or of all .json files of a directory, in order of their names.
[[nodiscard]] Result<std::vector<Problem>> load_problems(const std::vector<std::string>& paths,
                                                         const ProblemOptions& options);

/// Grows two trees between start and goal as RRT-Connect does (Kuffner and LaValle,
/// DOI 10.1109/ROBOT.2000.844730), with steps of the robot's default range, until they meet or
/// hold `most` motions. Problems whose start or goal is in contact have none.
[[nodiscard]] Edges record_edges(const Problem& problem, int most, std::uint64_t seed);

}  // namespace mneme::bench
