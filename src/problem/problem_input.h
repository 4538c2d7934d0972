// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What problem files and compact files have in common: the robot and what is said about it.
#pragma once

#include "mneme/problem.h"

#include "scene/input.h"
#include "scene/shape_fields.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace mneme::internal {

struct ProblemRobot {
  std::string path;
  Robot robot;
  std::vector<std::string> warnings;
  std::vector<std::string> files = {};  ///< that it was read from; the SRDF only if it was named
};

/// A robot as these options made it.
struct CachedRobot {
  RobotOptions options;
  ProblemRobot robot;
};

}  // namespace mneme::internal

namespace mneme {

struct ProblemCache {
  std::string file_path;
  internal::InputValue file;
  std::vector<internal::CachedRobot> robots;  ///< few, the latest at the end
};

}  // namespace mneme

namespace mneme::internal {

/// load_approximated_robot, whose notes become warnings, or what the cache of `overrides` has of
/// it. Of these only `cache` and `on_approximated` count. Throws InputFailure.
[[nodiscard]] ProblemRobot load_problem_robot(const std::string& path, const RobotOptions& options,
                                              const ProblemOptions& overrides);

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

struct ProblemInput {
  Input header;  ///< has the keys robot, joints, fixed_joints and frame
  /// Has the keys start, goal or goals, attached, allow, constraints; may be the same map.
  Input problem;
  std::string name;
  std::string directory;  ///< of the file
  Scene scene;            ///< in the frame that the header names
  ObstacleSpelling spelling = kSceneSpelling;
  std::vector<std::string> files = {};  ///< that were read, the robot's aside
};

/// The directory that paths in the file `path` are relative to.
[[nodiscard]] std::string directory_of(const std::string& path);

/// The key `scene` of the problem file at `path`: a scene, or the path of a scene file; `files`
/// begins with `path`. Throws InputFailure.
[[nodiscard]] FramedScene read_scene_of_problem(const Input& problem, const std::string& path);

/// A sentence for each obstacle and link that touch whatever the group does.
[[nodiscard]] std::vector<std::string> describe_fixed_contacts(const Robot& robot,
                                                               const Scene& scene);

/// Throws InputFailure.
[[nodiscard]] Problem read_problem(const ProblemInput& input, const ProblemOptions& options);
/// The same of a robot that is there already: the keys that describe one are not looked at, and
/// pairs of its links in `allow` are refused.
[[nodiscard]] Problem read_problem_of(ProblemRobot robot, const ProblemInput& input,
                                      const ProblemOptions& options = {});

}  // namespace mneme::internal
