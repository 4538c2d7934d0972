// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The robot that a problem names, and what the problem says about it.
#pragma once

#include <map>
#include <optional>
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

/// load_covered_robot, whose notes become warnings. Throws InputFailure.
[[nodiscard]] ProblemRobot load_problem_robot(const std::string& path, const RobotOptions& options);

/// Reads the keys `robot`, `srdf`, `group`, `joints` and `fixed_joints` of `input`, and the robot.
/// What `options` say stands for what the keys say; paths of the keys are relative to `directory`.
/// Throws InputFailure.
[[nodiscard]] ProblemRobot read_robot(const Input& input, const std::string& directory,
                                      const ProblemOptions& options);

/// Gives the joints of `values` that can be fixed these values, unless `options` fix them already;
/// names the others in a warning that `place` is asked to place. True if that changes the options:
/// then the robot must be read again.
[[nodiscard]] bool fix_joints(ProblemRobot& robot, RobotOptions& options,
                              const std::map<std::string, double>& values, const Input& place);

/// Compares the keys `links` and `joint_limits`, if they are given, with the robot. Throws
/// InputFailure.
void check_robot_facts(const Input& input, const Robot& robot);

/// Pose in the root link's frame of the link `name`; nothing if there is no such link. Throws
/// InputFailure with `place` if the link can move against the root.
[[nodiscard]] std::optional<Transform> find_fixed_link(const Robot& robot, const std::string& name,
                                                       const Input& place);

/// Pose in the root link's frame of the link that the key `frame` names; the identity if there is
/// no such key. Throws InputFailure if the link can move against the root.
[[nodiscard]] Transform read_frame(const Input& input, const Robot& robot);

}  // namespace mneme::internal
