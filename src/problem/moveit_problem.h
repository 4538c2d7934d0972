// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Problems as MoveIt and MotionBenchMaker keep them: a planning scene and a motion plan request.
#pragma once

#include "mneme/problem.h"

#include "problem/problem_input.h"
#include "scene/moveit_scene.h"

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace mneme::internal {

/// SCENE and REQUEST of "SCENE.yaml,REQUEST.yaml"; otherwise nothing.
struct MoveitAddress {
  std::string scene;
  std::string request;
};
[[nodiscard]] std::optional<MoveitAddress> split_moveit_address(const std::string& where);

/// The path that MotionBenchMaker gives to the scene of the request at `path`: the same with the
/// last "request" of its name replaced by "scene". Throws InputFailure if there is no "request".
[[nodiscard]] std::string scene_of_request(const Input& request, const std::string& path);

/// Throws InputFailure.
[[nodiscard]] Problem read_moveit_problem(const MoveitAddress& address,
                                          const ProblemOptions& options);

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

/// True if the keys are those of a motion plan request.
[[nodiscard]] bool is_moveit_request(const Input& input);

/// Positions that a joint constraint allows.
struct JointRange {
  double least = 0, most = 0;
};

struct MoveitRequest {
  std::string group;
  MoveitState start;                                     ///< what it says other than the scene
  std::vector<std::map<std::string, JointRange>> goals;  ///< by joint; none of a pose
  std::vector<Input> goal_places;
  std::vector<Input> path_constraints;  ///< of orientation
};

/// Throws InputFailure; goals and paths that are constrained otherwise are refused by name.
[[nodiscard]] MoveitRequest read_moveit_request(const Input& input);

/// Reads `allowed_collision_matrix` of `scene`. Throws InputFailure if it is malformed; returns a
/// warning that names those of its names that `contacts` does not know, if there are any. Two
/// obstacles may touch in any case. Defaults count for pairs without an entry, as in MoveIt: that
/// of either name, both if both have one.
[[nodiscard]] std::vector<std::string> read_moveit_allowed(const Input& scene,
                                                           const std::vector<std::string>& names,
                                                           AllowedContacts& contacts);

}  // namespace mneme::internal
