// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Reads problem files and compact files: the robot, attached objects, allowed contacts, start,
/// goals and constraints. Writes single keys of them.
#pragma once

#include "mneme/problem.h"
#include "mneme/robot.h"
#include "mneme/scene.h"

#include "scene/scene_input.h"

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace mneme::internal {

struct ProblemRobot {
  std::string path;
  Robot robot;
  std::vector<std::string> warnings;
  std::string srdf = {};                ///< path of the SRDF if it was named
  std::vector<std::string> files = {};  ///< files read
};

/// A robot and the options of its loading.
struct CachedRobot {
  RobotOptions options;
  ProblemRobot robot;
};

}  // namespace mneme::internal

namespace mneme {

struct ProblemCache {
  std::string file_path;
  internal::InputValue file;
  std::vector<internal::CachedRobot> robots;  ///< few; the latest is the last
};

}  // namespace mneme

namespace mneme::internal {

/// Loads a robot by load_approximated_robot(), whose notes become warnings, or takes it from the
/// cache. Uses `cache` and `on_approximated` of `overrides`. Throws InputFailure.
[[nodiscard]] ProblemRobot load_problem_robot(const std::string& path, const RobotOptions& options,
                                              const ProblemOptions& overrides);

/// Reads the robot that the keys `robot`, `srdf`, `group`, `joints` and `fixed_joints` describe.
/// `options` take precedence over the keys, whose paths are relative to `directory`. Throws
/// InputFailure.
[[nodiscard]] ProblemRobot read_robot(const Input& input, const std::string& directory,
                                      const ProblemOptions& options);

/// Adds to `options` the `values` of joints that can be fixed, except joints that have a value
/// there. A warning with `place` names the other joints. Returns true if the options have changed:
/// then the robot must be read again.
[[nodiscard]] bool fix_joints(ProblemRobot& robot, RobotOptions& options,
                              const std::map<std::string, double>& values, const Input& place);

/// Compares the keys `links` and `joint_limits`, if given, with the robot. Throws InputFailure.
void check_robot_facts(const Input& input, const Robot& robot);

/// Returns the pose of the link `name` in the root link's frame, or nothing if there is no such
/// link. Throws InputFailure with `place` if the link can move against the root.
[[nodiscard]] std::optional<Transform> find_fixed_link(const Robot& robot, const std::string& name,
                                                       const Input& place);

/// As find_fixed_link(). Throws InputFailure also if there is no such link.
[[nodiscard]] Transform pose_of_frame(const Robot& robot, const std::string& name,
                                      const Input& place);
/// Returns the pose of the link that the key `frame` names, in the root link's frame; the identity
/// without the key. Throws InputFailure if the link can move against the root.
[[nodiscard]] Transform read_frame(const Input& input, const Robot& robot);

struct ProblemInput {
  Input header;  ///< has the keys robot, joints, fixed_joints and frame
  /// Has the keys start, goal or goals, attached, allow, constraints; may be the same map.
  Input problem;
  std::string name;
  std::string directory;  ///< directory of the file
  /// In its own frame, or the header's if that names one. `files`: all that were read, except the
  /// robot's.
  FramedScene framed;
  ObstacleSpelling spelling = kSceneSpelling;
};

/// Returns the base directory of paths in the file `path`.
[[nodiscard]] std::string directory_of(const std::string& path);

/// Reads the key `scene` of the problem file at `path`: a scene or the path of a scene file.
/// FramedScene::files of the result begins with `path`. Throws InputFailure.
[[nodiscard]] FramedScene read_scene_of_problem(const Input& problem, const std::string& path);

/// Returns a sentence for each obstacle in contact with a link that the group does not move.
[[nodiscard]] std::vector<std::string> describe_fixed_contacts(const Robot& robot,
                                                               const Scene& scene);

/// Throws InputFailure.
[[nodiscard]] Problem read_problem(const ProblemInput& input, const ProblemOptions& options);
/// As above, with a given robot: keys that describe a robot are ignored, and pairs of its links in
/// `allow` are refused.
[[nodiscard]] Problem read_problem_of(ProblemRobot robot, const ProblemInput& input,
                                      const ProblemOptions& options = {});

/// True if `name` is a joint that turns, or the angle of a planar joint.
[[nodiscard]] bool is_angle(const Robot& robot, const std::string& name);

/// Reads a list of values in the order of the group, a map from joints to values, or the name of an
/// SRDF state. Planning checks the count of a list and the limits. Throws InputFailure.
[[nodiscard]] Configuration read_configuration(const Input& input, const Robot& robot);

/// Reads a list of a number per joint of the group: angles, of prismatic joints lengths. The count
/// may be wrong. Throws InputFailure.
[[nodiscard]] std::vector<double> read_joint_values(const Input& list, const Robot& robot);

/// Returns the configuration of the options. Throws InputFailure that calls it `what`.
[[nodiscard]] Configuration read_configuration(const GivenConfiguration& given,
                                               const std::string& what, const Robot& robot);

/// Reads a goal, a configuration or a map with the key `link`, into `problem`, whose robot and
/// start are known. Poses are in the frame at `X_RF` unless they name another frame. Throws
/// InputFailure.
void read_goal(const Input& input, const Transform& X_RF, Problem& problem);

/// Adds a goal with its pose in the root link's frame. Throws InputFailure with `place` if
/// describe_fault() finds one.
void add_pose_goal(const Input& place, PoseGoal pose, Problem& problem);

/// Adds the goals of `options`. Returns false if there are none. Throws InputFailure.
bool take_goals(const ProblemOptions& options, const Transform& X_RF, Problem& problem);

/// Reads the key `constraints`, whose directions `up` are in the frame at `X_RF`. Throws
/// InputFailure.
void read_constraints(const Input& problem_input, const Transform& X_RF, Problem& problem);
/// Adds the constraints of `options`. Throws InputFailure.
void take_constraints(const ProblemOptions& options, const Transform& X_RF, Problem& problem);
/// Adds a constraint in the root link's frame. Throws InputFailure with `place` if describe_fault()
/// finds one.
void add_constraint(const Input& place, OrientationConstraint constraint, Problem& problem);

/// Reads the key `attached`, if there is one. Files are relative to `directory`. Throws
/// InputFailure, also for links that the robot lacks and names that are taken.
[[nodiscard]] std::vector<AttachedObject> read_attached(const Input& problem,
                                                        const ObstacleSpelling& spelling,
                                                        const std::string& directory,
                                                        const Robot& robot);

/// As attach(). Throws InputFailure with `place`.
[[nodiscard]] Robot attach_to(const Robot& robot, std::vector<AttachedObject> objects,
                              const Input& place);

/// Stores each allowed pair where it counts: in an obstacle, in an attached object, or as two
/// links.
class AllowedContacts {
 public:
  /// Refers to its arguments.
  AllowedContacts(const Robot& robot, std::vector<AttachedObject>& attached, Scene& scene)
      : robot_(robot), scene_(scene) {
    for (AttachedObject& object : attached) attached_.emplace(object.name, &object);
  }

  /// Allows the pair, always or at the ends of a path. Returns its fault, or nothing: also if a
  /// name means an obstacle and a link or an attached object.
  [[nodiscard]] std::optional<std::string> allow(const AllowedPair& pair);
  /// Returns a fault if `name` means an obstacle and a link or an attached object.
  [[nodiscard]] std::optional<std::string> find_ambiguity(const std::string& name) const;
  /// Returns a fault if contact that the scene allows already is of such a name.
  [[nodiscard]] std::optional<std::string> find_ambiguity() const;
  /// Returns true for the name of a link, an attached object or an obstacle.
  [[nodiscard]] bool knows(const std::string& name) const;
  /// The allowed pairs of two links, for RobotOptions.
  [[nodiscard]] const std::vector<std::pair<std::string, std::string>>& link_pairs() const {
    return link_pairs_;
  }

 private:
  [[nodiscard]] std::optional<std::string> find_fault(const std::string& first,
                                                      const std::string& second) const;
  [[nodiscard]] bool is_carried(const std::string& name) const;
  [[nodiscard]] AttachedObject* find_attached(const std::string& name) const;

  const Robot& robot_;
  std::unordered_map<std::string_view, AttachedObject*> attached_;
  ObstacleContacts scene_;
  std::vector<std::pair<std::string, std::string>> link_pairs_;
};

/// Allows the pairs of the key `allow`, if there is one. Throws InputFailure, also for names with
/// two meanings that the scene itself allows to touch.
void read_allowed(const Input& problem, AllowedContacts& contacts);

/// As above, without a robot: pairs of an obstacle and any name, except names of attached objects.
/// Names of links are not known, so that one that an obstacle shares is not refused.
void read_allowed(const Input& problem, Scene& scene);

/// Returns the distance of the options, otherwise of the key `self_filter`. Throws InputFailure.
[[nodiscard]] std::optional<double> read_self_filter(const Input& problem,
                                                     const ProblemOptions& options);

/// Calls drop_own_points(), if there is a distance. Does nothing if `start` is no configuration,
/// which planning refuses. Throws InputFailure.
[[nodiscard]] std::vector<std::string> filter_own_points(std::optional<double> distance,
                                                         const Robot& robot,
                                                         const Configuration& start, Scene& scene);

struct CompactAddress {
  std::string path;
  std::string name;  ///< empty if not given
};
/// Splits "FILE.json#NAME" or "FILE.json". Returns nothing for other extensions.
[[nodiscard]] std::optional<CompactAddress> split_address(const std::string& where);

/// Reads the scene of a problem and the file's frame. Throws InputFailure.
[[nodiscard]] FramedScene extract_compact_scene(const CompactAddress& address);

/// Throws InputFailure.
[[nodiscard]] Problem read_compact_problem(const CompactAddress& address,
                                           const ProblemOptions& options);

/// Returns the list of the key `constraints`. Directions `up` are in the frame of the root link.
[[nodiscard]] nlohmann::ordered_json constraints_json(const Problem& problem);

}  // namespace mneme::internal
