// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// MoveIt's position and orientation constraints as goals.
#pragma once

#include "mneme/problem.h"

#include "scene/input.h"

#include <functional>

namespace mneme::internal {

/// Pose in the root link's frame of the frame in a constraint's header.
using FrameOf = std::function<Transform(const Input& constraint)>;

/// True if the goal has position or orientation constraints.
[[nodiscard]] bool is_moveit_pose_goal(const Input& goal);

/// At most one constraint of each kind, of the same link. Regions that PoseGoal does not have are
/// replaced by the largest ones within them: a sphere by a cube, two of three tolerances of an
/// orientation by a cone. Throws InputFailure; other constraints and regions are refused by name.
[[nodiscard]] PoseGoal read_moveit_pose_goal(const Input& goal, const FrameOf& frame_of);
/// The same for an orientation that all of a path keeps, which must leave one axis free to be
/// turned about.
[[nodiscard]] OrientationConstraint read_moveit_path_constraint(const Input& constraint,
                                                                const FrameOf& frame_of);

}  // namespace mneme::internal
