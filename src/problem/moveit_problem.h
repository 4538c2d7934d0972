// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Problems of MoveIt and MotionBenchMaker: a planning scene and a motion plan request.
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

struct MoveitAddress {
  std::string scene;
  std::string request;
};
/// Splits "SCENE.yaml,REQUEST.yaml". Returns nothing for other text.
[[nodiscard]] std::optional<MoveitAddress> split_moveit_address(const std::string& where);

/// Returns the path of the scene of the request at `path`, as MotionBenchMaker names it: the last
/// "request" of the file name replaced by "scene". Throws InputFailure if there is no "request".
[[nodiscard]] std::string scene_of_request(const Input& request, const std::string& path);

/// Throws InputFailure.
[[nodiscard]] Problem read_moveit_problem(const MoveitAddress& address,
                                          const ProblemOptions& options);

/// Returns the pose of the frame in a constraint's header, in the root link's frame.
using FrameOf = std::function<Transform(const Input& constraint)>;

/// True if the goal has position or orientation constraints.
[[nodiscard]] bool is_moveit_pose_goal(const Input& goal);

/// Reads at most one position and one orientation constraint, of the same link. Regions that
/// PoseGoal lacks are replaced by the largest ones within them: a sphere by a cube, two of three
/// tolerances of an orientation by a cone. Throws InputFailure, also for other constraints.
[[nodiscard]] PoseGoal read_moveit_pose_goal(const Input& goal, const FrameOf& frame_of);
/// Reads an orientation constraint of the whole path. It must leave the turn about one axis free.
/// Throws InputFailure.
[[nodiscard]] OrientationConstraint read_moveit_path_constraint(const Input& constraint,
                                                                const FrameOf& frame_of);

/// True if the keys are those of a motion plan request.
[[nodiscard]] bool is_moveit_request(const Input& input);

/// The positions that a joint constraint allows.
struct JointRange {
  double least = 0, most = 0;
};

struct MoveitRequest {
  std::string group;
  MoveitState start;                                     ///< differences from the scene's state
  std::vector<std::map<std::string, JointRange>> goals;  ///< by joint; empty for pose goals
  std::vector<Input> goal_places;
  std::vector<Input> path_constraints;  ///< orientation constraints
};

/// Throws InputFailure, which names constraints that are not supported.
[[nodiscard]] MoveitRequest read_moveit_request(const Input& input);

/// Reads `allowed_collision_matrix` of `scene`. Defaults count for pairs without an entry, as in
/// MoveIt: the default of either name, both if both have one. Entries of two obstacles are ignored.
/// Returns a warning with the names that `contacts` does not know, if any. Throws InputFailure if
/// the matrix is malformed.
[[nodiscard]] std::vector<std::string> read_moveit_allowed(const Input& scene,
                                                           const std::vector<std::string>& names,
                                                           AllowedContacts& contacts);

}  // namespace mneme::internal
