// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Reading of problems, from problem files and compact files: the robot, what it carries and may
/// touch, start, goals and constraints.
#pragma once

#include "mneme/problem.h"
#include "mneme/robot.h"
#include "mneme/scene.h"

#include "scene/scene_input.h"

#include <map>
#include <optional>
#include <string>
#include <utility>
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
/// `options` take precedence over the keys. Paths in the keys are relative to `directory`.
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

/// A list of values in the order of the group, a map from joints to values, or the name of a state
/// of the SRDF. The count of a list and limits are a matter of planning. Throws InputFailure.
[[nodiscard]] Configuration read_configuration(const Input& input, const Robot& robot);

/// The configuration given in the options; `what` names it in the message of the InputFailure.
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

/// Adds those of the key `constraints`, whose directions `up` are in a frame whose pose is `X_RF`.
/// Throws InputFailure.
void read_constraints(const Input& problem_input, const Transform& X_RF, Problem& problem);
/// Adds those that `options` say. Throws InputFailure.
void take_constraints(const ProblemOptions& options, const Transform& X_RF, Problem& problem);
/// Adds one, in the root link's frame. Throws InputFailure at `place` if the robot cannot keep it.
void add_constraint(const Input& place, OrientationConstraint constraint, Problem& problem);

/// The objects of the list `attached` of `problem`, if there is one; files are relative to
/// `directory`. Throws InputFailure, also for links that the robot lacks and names that are taken.
[[nodiscard]] std::vector<AttachedObject> read_attached(const Input& problem,
                                                        const ObstacleSpelling& spelling,
                                                        const std::string& directory,
                                                        const Robot& robot);

/// mneme::attach. Throws InputFailure with `place`.
[[nodiscard]] Robot attach_to(const Robot& robot, std::vector<AttachedObject> objects,
                              const Input& place);

/// Takes each pair to where it counts: an obstacle, an attached object, or two links of the robot.
class AllowedContacts {
 public:
  /// Refers to its arguments.
  AllowedContacts(const Robot& robot, std::vector<AttachedObject>& attached, Scene& scene)
      : robot_(robot), attached_(attached), scene_(scene) {}

  /// Allows the pair. Returns what is wrong with it, or nothing. A name that a link and an obstacle
  /// share is that of the link where it stands first, that of the obstacle where it stands second.
  [[nodiscard]] std::optional<std::string> allow(const std::string& first,
                                                 const std::string& second);
  /// True if a link, an attached object or an obstacle has this name.
  [[nodiscard]] bool knows(const std::string& name) const;
  /// The allowed pairs of two links, for RobotOptions.
  [[nodiscard]] const std::vector<std::pair<std::string, std::string>>& link_pairs() const {
    return link_pairs_;
  }

 private:
  [[nodiscard]] bool is_carried(const std::string& name) const;
  [[nodiscard]] AttachedObject* find_attached(const std::string& name) const;

  const Robot& robot_;
  std::vector<AttachedObject>& attached_;
  Scene& scene_;
  std::vector<std::pair<std::string, std::string>> link_pairs_;
};

/// Takes the pairs of the key `allow`, if `problem` has it. Throws InputFailure.
void read_allowed(const Input& problem, AllowedContacts& contacts);

/// The same without a robot: pairs of an obstacle and a name that is none of the attached objects'.
/// A name that stands first may be that of an obstacle though a link has it, too.
void read_allowed(const Input& problem, Scene& scene);

/// The distance in the options, otherwise that of the key `self_filter`. Throws InputFailure.
[[nodiscard]] std::optional<double> read_self_filter(const Input& problem,
                                                     const ProblemOptions& options);

/// drop_own_points, if a distance is given and `start` is a configuration: planning refuses any
/// other. Throws InputFailure.
[[nodiscard]] std::vector<std::string> filter_own_points(std::optional<double> distance,
                                                         const Robot& robot,
                                                         const Configuration& start, Scene& scene);

/// FILE.json and NAME of "FILE.json#NAME"; without a file of that extension, nothing.
struct CompactAddress {
  std::string path;
  std::string name;  ///< empty if not given
};
[[nodiscard]] std::optional<CompactAddress> split_address(const std::string& where);

/// The scene of one problem, and the frame that the file names. Throws InputFailure.
[[nodiscard]] FramedScene extract_compact_scene(const CompactAddress& address);

/// Throws InputFailure.
[[nodiscard]] Problem read_compact_problem(const CompactAddress& address,
                                           const ProblemOptions& options);

}  // namespace mneme::internal
