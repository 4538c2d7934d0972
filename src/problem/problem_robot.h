// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The robot that a problem names, and what the problem says about it.
#pragma once

#include <string>
#include <vector>

#include "mneme/problem.h"
#include "scene/input.h"

namespace mneme::internal {

struct ProblemRobot {
  std::string path;
  Robot robot;
  std::vector<std::string> warnings;
};

/// Reads the keys `robot`, `joints` and `fixed_joints` of `input`, and the robot. `override_path`
/// stands for `robot` unless it is empty; other paths are relative to `directory`. Throws
/// InputFailure.
[[nodiscard]] ProblemRobot read_robot(const Input& input, const std::string& directory,
                                      const std::string& override_path);

/// Compares the keys `links` and `joint_limits`, if they are given, with the robot. Throws
/// InputFailure.
void check_robot_facts(const Input& input, const Robot& robot);

/// Pose in the root link's frame of the link that the key `frame` names; the identity if there is
/// no such key. Throws InputFailure if the link can move against the root.
[[nodiscard]] Transform read_frame(const Input& input, const Robot& robot);

}  // namespace mneme::internal
