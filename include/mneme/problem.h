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
/// Returns the axis with this name, or nothing.
[[nodiscard]] std::optional<Axis> parse_axis(std::string_view name);
[[nodiscard]] std::string_view to_string(Axis axis);

/// Returns the rotation of a quaternion x, y, z, w. Error: invalid, if the quaternion's length
/// differs from 1 by more than 1e-3, which allows for printed digits.
[[nodiscard]] Result<Eigen::Matrix3d> rotation_from_unit_quaternion(
    std::span<const double, 4> xyzw);

/// The rotation of a quaternion that was scaled to length 1.
struct ScaledRotation {
  Eigen::Matrix3d rotation;
  double length = 1;       ///< of the quaternion
  bool is_scaled = false;  ///< True if the length differs from 1 by more than 1e-3.
};
/// As rotation_from_unit_quaternion(), and scales quaternions whose length is 0.1 to 10, as readers
/// of scenes do. Error: invalid, for other lengths.
[[nodiscard]] Result<ScaledRotation> rotation_from_scaled_quaternion(
    std::span<const double, 4> xyzw);

/// A region of poses for a link to reach; without tolerances a single pose.
struct PoseGoal {
  std::string link;
  Transform pose;  ///< wanted pose of the link's frame, in the root link's frame
  /// Half extents of the region of the link's origin along the axes of `pose`, metres, each >= 0.
  Vec3 position_tolerance = Vec3::Zero();
  /// Axis of the link's frame, such as an approach direction, that `cone` and `turn` refer to.
  Axis axis = Axis::z;
  /// Largest angle between `axis` of the link and the same axis of `pose`, radians. Pi: any
  /// direction.
  double cone = 0;
  /// Largest rotation of the link about `axis` to either side, radians. Pi: any rotation.
  double turn = 0;
  /// Link whose frame at the start `pose` is given in. Empty: the root link. in_root_frame()
  /// converts the pose.
  std::string frame = {};
};

/// Distance of a link's pose from the region of a PoseGoal; 0 within the region.
struct PoseError {
  double position = 0;  ///< metres
  /// Radians by which the angle of the axis exceeds `cone` or the rotation about the axis exceeds
  /// `turn`; the larger of both.
  double rotation = 0;
};
/// Returns the distance of the link from `goal` at `q`, in double precision. Precondition:
/// describe_fault() returns nothing for the goal.
[[nodiscard]] PoseError pose_error(const Robot& robot, const PoseGoal& goal,
                                   std::span<const double> q);
/// Returns why `goal` is no goal for this robot, or nothing. Faults: an unknown link, a link that
/// no joint of the group moves, a frame other than the root link's, numbers that are not finite,
/// negative tolerances.
[[nodiscard]] std::optional<std::string> describe_fault(const Robot& robot, const PoseGoal& goal);
/// Returns the goal with `pose` converted to the root link's frame. `q` decides where a `frame` of
/// the goal is. Error: invalid, if the frame is no link of the robot or `q` is no configuration.
[[nodiscard]] Result<PoseGoal> in_root_frame(PoseGoal goal, const Robot& robot,
                                             std::span<const double> q);

struct Problem {
  std::string name = {};
  Robot robot;
  std::string robot_path = {};  ///< path of the URDF
  Scene scene = {};
  Configuration start = {};
  /// A path ends at any one of `goals` and `pose_goals`. At least one of both lists has an entry.
  std::vector<Configuration> goals = {};
  /// From reading, such as ignored values of unknown joints.
  std::vector<std::string> warnings = {};
  std::vector<PoseGoal> pose_goals = {};
  /// Pairs of links that may touch, in addition to those of the SRDF. `robot` allows them already.
  std::vector<std::pair<std::string, std::string>> allowed_pairs = {};
  std::vector<OrientationConstraint> constraints = {};  ///< hold along the whole path
  /// Velocity at the start, a value per joint (rad/s, m/s for prismatic joints). Empty: at rest.
  /// Paths then begin with the motion in which the robot can stop.
  std::vector<double> start_velocity = {};
  /// The same at the goal. Paths then end with the motion in which the robot gets this velocity.
  std::vector<double> end_velocity = {};
  /// Files that were read, except meshes, clouds, octrees and an SRDF found beside the URDF.
  std::vector<std::string> files = {};
  std::string srdf_path = {};  ///< path of the SRDF, if one was named

  /// Returns true if there is a velocity at the start or at the goal.
  [[nodiscard]] bool is_moving() const { return !start_velocity.empty() || !end_velocity.empty(); }
};

/// Holds the compact file and the robots that were read last.
struct ProblemCache;
[[nodiscard]] std::shared_ptr<ProblemCache> make_problem_cache();

/// Settings that complete or replace entries of the problem's file.
struct ProblemOptions {
  std::string robot_path = {};  ///< URDF to use instead of the one that the problem names
  /// Robot to use instead of the one that the problem names. The entries of the file and of `robot`
  /// about robot, SRDF, group, joints and fixed joints are ignored. Errors: the file allows pairs
  /// of the robot's links; the file is a MoveIt request, which has more entries about its robot.
  std::optional<Robot> made_robot = std::nullopt;
  /// `joints`, `srdf_path` and each of the `fixed_values` replace those of the problem. `group` is
  /// used if neither the problem nor this field names `joints`.
  RobotOptions robot = {};
  std::optional<GivenConfiguration> start = {};
  std::optional<GivenConfiguration> goal = {};
  /// Replace those of the problem.
  std::optional<std::vector<double>> start_velocity = std::nullopt, end_velocity = std::nullopt;
  /// If `goal` or this field is set, both together replace all goals of the problem. Poses are in
  /// the frame of the problem's scene unless PoseGoal::frame names another.
  std::vector<PoseGoal> pose_goals = {};
  /// Constraints to add to those of the problem; `up` is in the frame of the problem's scene.
  std::vector<OrientationConstraint> constraints = {};
  /// Distance for drop_own_points() at the start, metres; replaces the problem's distance.
  /// Sentences of drop_own_points() become warnings. No effect on MoveIt scenes, which have no
  /// clouds.
  std::optional<double> self_filter = std::nullopt;
  /// Lets several calls of one thread read the same file and robot only once. Null: no cache.
  std::shared_ptr<ProblemCache> cache = nullptr;
  /// Passed to approximate_robot().
  SphereProgress on_approximated = terminal_progress();
};

/// Reads a problem. `where` is one of
/// - a YAML file,
/// - FILE.json#NAME or FILE.json#INDEX, a problem of a compact file,
/// - a MoveIt motion plan request with its scene beside it (request0001.yaml, scene0001.yaml),
/// - SCENE.yaml,REQUEST.yaml.
/// Start and goals are validated by planning, not here.
[[nodiscard]] Result<Problem> load_problem(const std::string& where,
                                           const ProblemOptions& options = {});

/// Removes points on the robot itself, which sensors also see, from the scene's clouds. A point is
/// removed if it is, with its radius, nearer than `distance` metres to a link's spheres or to an
/// attached object at `q`. A cloud without points left is removed, too. With a `distance` of 0 no
/// cloud is in contact at `q` afterwards. Returns a sentence for each obstacle that lost points.
/// Errors: a distance that is negative or not finite; `q` is no configuration of the robot.
[[nodiscard]] Result<std::vector<std::string>> drop_own_points(Scene& scene, const Robot& robot,
                                                               std::span<const double> q,
                                                               double distance);

/// Reads the scene of a problem, or a scene file, without reading the robot. `where` is as for
/// load_problem(), or a scene file.
[[nodiscard]] Result<FramedScene> extract_scene(const std::string& where);
/// Returns the scene in the frame of the robot's root link. Error: the scene's frame is no link of
/// the robot, or a link that moves.
[[nodiscard]] Result<Scene> in_root_frame(const FramedScene& scene, const Robot& robot);

/// Writes a compact file with this scene, without start and goal. extract_scene() reads it back to
/// the same scene.
[[nodiscard]] std::string to_compact_json(const FramedScene& scene);
/// Writes a compact file with this problem. load_problem() reads it back to the same problem;
/// relative paths of attached meshes stay relative. `robot` is written as given; the SRDF is not.
/// Without `robot` it is the body of a request, which has no `allowed_pairs`.
[[nodiscard]] std::string to_compact_json(const Problem& problem, const std::string& robot);
/// Writes the goal as in JSON files and requests.
[[nodiscard]] std::string to_json(const PoseGoal& goal);

/// Returns the names of the problems in a compact file, in order; of a problem without a name, its
/// index.
[[nodiscard]] Result<std::vector<std::string>> list_problems(const std::string& path);

/// Writes a problem file with the scene inside. `robot` is written as given; the SRDF is not.
[[nodiscard]] std::string to_yaml(const Problem& problem, const std::string& robot);

}  // namespace mneme
