// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Motion planning problems: a robot, a scene, a start and goals.
#pragma once

#include "mneme/check.h"
#include "mneme/spheres.h"
#include "mneme/robot.h"
#include "mneme/scene.h"

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mneme {

enum class Axis { x, y, z };
/// The axis of a name; nothing for one that is not x, y or z.
[[nodiscard]] std::optional<Axis> parse_axis(std::string_view name);
[[nodiscard]] std::string_view to_string(Axis axis);

/// The rotation of a quaternion x, y, z, w. Error: invalid, if its length is not 1, but for what
/// printed digits explain.
[[nodiscard]] Result<Eigen::Matrix3d> rotation_from_unit_quaternion(
    std::span<const double, 4> xyzw);

/// A region of poses that a link is to reach. Without tolerances it is one pose.
struct PoseGoal {
  std::string link;
  Transform pose;  ///< where the link's frame is to be, in the root link's frame
  /// Metres along the axes of `pose`, each >= 0, that the link's origin may be off.
  Vec3 position_tolerance = Vec3::Zero();
  /// The link's approach axis, which `cone` and `turn` are about.
  Axis axis = Axis::z;
  double cone = 0;  ///< radians that the axis may lean from that of `pose`; pi: any way
  double turn = 0;  ///< radians that the link may be turned about its axis, to either side; pi: any
  /// A link in whose frame `pose` is instead, where that link is at the start: until
  /// in_root_frame() has placed it.
  std::string frame = {};
};

/// Metres and radians from a link to a region; 0 within.
struct PoseError {
  double position = 0;
  double rotation = 0;  ///< of the axis beyond the cone and the turn beyond its limit, the larger
};
/// How far the link is from `goal` at `q`, in double precision. The goal passes describe_fault().
[[nodiscard]] PoseError pose_error(const Robot& robot, const PoseGoal& goal,
                                   std::span<const double> q);
/// Why no link of the robot can be asked to reach `goal`, or nothing: an unknown link, one that no
/// joint of the group moves, a pose in another frame than the root link's, numbers that are not
/// finite, tolerances below 0.
[[nodiscard]] std::optional<std::string> describe_fault(const Robot& robot, const PoseGoal& goal);
/// The goal with its pose in the root link's frame, by where its `frame` is at `q`; as it is if it
/// names none. Errors: invalid if that is no link of the robot, or `q` no configuration.
[[nodiscard]] Result<PoseGoal> in_root_frame(PoseGoal goal, const Robot& robot,
                                             std::span<const double> q);

struct Problem {
  std::string name;
  Robot robot;
  std::string robot_path;  ///< the URDF that was read
  Scene scene;
  Configuration start;
  std::vector<Configuration> goals;  ///< any of them will do; empty only if there are `pose_goals`
  std::vector<std::string>
      warnings;  ///< what was left aside while reading, such as values of unknown joints
  std::vector<PoseGoal> pose_goals = {};  ///< any of these will do, too
  /// Pairs of links that may touch, besides those of the SRDF: the robot was made so.
  std::vector<std::pair<std::string, std::string>> allowed_pairs = {};
  std::vector<OrientationConstraint> constraints = {};  ///< that all of the path keeps
  /// That it was read from, but for meshes, clouds, octrees and an SRDF that nobody named.
  std::vector<std::string> files = {};
};

/// The compact file and the robots that were read last.
struct ProblemCache;
[[nodiscard]] std::shared_ptr<ProblemCache> make_problem_cache();

/// Settings that complete or replace the problem's file.
struct ProblemOptions {
  std::string robot_path;  ///< URDF to use instead of the one that the problem names
  /// A robot that is there already, instead of the one that the problem names: what the file and
  /// `robot` say of robot, SRDF, group, joints and fixed joints is not looked at. Errors: the file
  /// allows pairs of its links, or is a request of MoveIt, which says more about its robot.
  std::optional<Robot> made_robot = std::nullopt;
  /// SRDF, packages and whatever the problem does not say itself: `group` counts where neither it
  /// nor this names `joints`; `joints`, `srdf_path` and each of the `fixed_values` stand for those
  /// of the problem.
  RobotOptions robot;
  std::optional<GivenConfiguration> start;
  std::optional<GivenConfiguration> goal;
  /// Instead of the problem's goals, or besides `goal`: in the frame of the problem's scene unless
  /// they name one.
  std::vector<PoseGoal> pose_goals = {};
  /// Besides those of the problem: `up` is in the frame of the problem's scene.
  std::vector<OrientationConstraint> constraints = {};
  /// Metres of drop_own_points at the start, instead of what the problem says; its notes become
  /// warnings. MoveIt's scenes have no clouds.
  std::optional<double> self_filter = std::nullopt;
  /// For callers that load many problems: file and robot are read once. Use by one thread only.
  std::shared_ptr<ProblemCache> cache = nullptr;
  /// Called for links that have got their spheres, as that of approximate_robot().
  SphereProgress on_approximated = nullptr;
};

/// Reads one problem. `where` is a YAML file, FILE.json#NAME (or #INDEX) for one problem of a
/// compact file, or a motion plan request of MoveIt, whose planning scene lies beside it
/// (request0001.yaml and scene0001.yaml) or is named first (SCENE.yaml,REQUEST.yaml). The start and
/// goals are not validated here: that is part of planning.
[[nodiscard]] Result<Problem> load_problem(const std::string& where,
                                           const ProblemOptions& options = {});

/// Takes out of the scene's clouds the points of the robot itself, which sensors see too: those
/// that are, with their radius, nearer than `distance` metres to a link's spheres, or to what the
/// robot carries, at `q`. With 0 no cloud is in contact there afterwards. A cloud without points
/// left goes. A sentence for each obstacle that lost points. Errors: a distance that is below 0 or
/// not finite; `q` is no configuration of the robot.
[[nodiscard]] Result<std::vector<std::string>> drop_own_points(Scene& scene, const Robot& robot,
                                                               std::span<const double> q,
                                                               double distance);

/// The scene of a scene file or of a problem, as the file gives it: no robot is read. `where` is
/// what load_problem takes, or a scene file.
[[nodiscard]] Result<FramedScene> extract_scene(const std::string& where);
/// The scene in the frame of the robot's root link. Errors: its frame is no link of the robot, or
/// one that moves.
[[nodiscard]] Result<Scene> in_root_frame(const FramedScene& scene, const Robot& robot);

/// Text of a compact file with this scene and without start and goal: extract_scene reads it back
/// to the same.
[[nodiscard]] std::string to_compact_json(const FramedScene& scene);
/// Text of a compact file with this problem, which load_problem reads back to the same; `robot` is
/// written as given.
[[nodiscard]] std::string to_compact_json(const Problem& problem, const std::string& robot);
/// The goal as JSON files and requests spell it.
[[nodiscard]] std::string to_json(const PoseGoal& goal);

/// Names of the problems in a compact file, in order; those without a name have their index.
[[nodiscard]] Result<std::vector<std::string>> list_problems(const std::string& path);

/// Text of a problem file with the scene inside; `robot` is written as given.
[[nodiscard]] std::string to_yaml(const Problem& problem, const std::string& robot);

}  // namespace mneme
