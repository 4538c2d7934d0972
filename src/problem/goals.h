// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Starts and goals as files say them: values of joints, named states, poses of links.
#pragma once

#include "mneme/problem.h"

#include "scene/input.h"

namespace mneme::internal {

/// A list of values in the order of the group, a map from joints to values, or the name of a state
/// of the SRDF. The count of a list and limits are a matter of planning. Throws InputFailure.
[[nodiscard]] Configuration read_configuration(const Input& input, const Robot& robot);

/// What was given beside the file; `what` names it in the message of the InputFailure.
[[nodiscard]] Configuration read_configuration(const GivenConfiguration& given,
                                               const std::string& what, const Robot& robot);

/// Adds a goal to `problem`, whose robot and start are known: a configuration, or a map with the
/// key `link`. Poses are in a frame whose pose is `X_RF` unless they name another. Throws
/// InputFailure.
void read_goal(const Input& input, const Transform& X_RF, Problem& problem);

/// Adds `pose`, whose pose is in the root link's frame. Throws InputFailure at `place` if the robot
/// cannot be asked for it.
void add_pose_goal(const Input& place, PoseGoal pose, Problem& problem);

/// Gives `problem` the goals that `options` say; false if they say none. Throws InputFailure.
bool take_goals(const ProblemOptions& options, const Transform& X_RF, Problem& problem);

}  // namespace mneme::internal
