// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Robot and scene between two stages of a task.
#pragma once

#include "mneme/task.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace mneme::internal {

/// An object in the hand.
struct HeldObject {
  std::string link;
  Transform X_LO;
  std::vector<std::string> may_touch = {};  ///< of the stage that attached it
};

/// A pair that may touch, as each was when it was allowed. Either may be held or free later.
struct AllowedContact {
  std::string carried;   ///< a link or a held object
  std::string obstacle;  ///< not held

  bool operator==(const AllowedContact&) const = default;
};

/// Robots with other values of joints outside the group that were made for a task: their tables
/// take milliseconds. Belongs to one thread.
struct GripperRobots {
  struct Entry {
    Robot from;
    std::map<std::string, double> values;
    Robot to;
  };
  std::vector<Entry> made;  ///< without held objects
  std::vector<Entry> wide;  ///< of find_or_make_wide(), found by the names of `values`
};

/// Robot and scene at one moment of a task. Immutable once shared.
struct World {
  Robot robot;
  Scene scene;
  std::map<std::string, Transform> poses;  ///< of objects that some stage attaches and that are
                                           ///< free, in the root link's frame
  std::map<std::string, HeldObject> held;  ///< by name
  std::vector<AllowedContact> allowed;     ///< by the scene and by stages so far
  std::shared_ptr<GripperRobots> grippers = std::make_shared<GripperRobots>();
};

/// Pose of a shape's own frame. Spheres: no rotation; capsules: z along the axis.
[[nodiscard]] Transform pose_of(const Shape& shape);

/// prepare_shapes() for all stages of a task: for the robot with any object in its hand, and with
/// exact distances where a stage may end in contact. `margin` is that of checkers.
void prepare_shapes_of(const Task& task, double margin);

/// Returns the world at the start of a task.
[[nodiscard]] World first_world(const Task& task);

/// Error: at `q`, the object of an attach stage is farther than kFarthestAttach from the links that
/// take it.
[[nodiscard]] Result<void> check_near(const World& world, const Stage& stage,
                                      const Configuration& q);

/// Returns the world after an attach, detach, allow or gripper stage at `q`. Errors name no stage:
/// those of Robot::with_attached() and make_robot().
[[nodiscard]] Result<World> after_stage(const World& world, const Stage& stage,
                                        const Configuration& q);

/// Returns the robot with other values of movable joints outside the group, such as those of
/// fingers. Errors: those of make_robot(), such as an unknown joint or one of the group.
[[nodiscard]] Result<Robot> with_joint_values(const Robot& robot,
                                              const std::map<std::string, double>& values);

/// Returns the world's robot with the joints of `values` in its planning group, too. Keeps it for
/// the next call. Errors: those of make_robot().
[[nodiscard]] Result<Robot> find_or_make_wide(const World& world,
                                              const std::map<std::string, double>& values);

/// Largest distance of an object from the links that take it, metres.
inline constexpr double kFarthestAttach = 0.05;

/// Lets obstacles touch the object while it is held, as the world's pairs say.
void let_obstacles_touch(World& world, const std::string& object);

/// Lets links touch the object at the ends of lines, within `stretch` metres of motion.
void let_touch_at_ends(Scene& scene, const std::string& object,
                       const std::vector<std::string>& links, double stretch);

/// Returns where each pose of the choice brings its link, in the root link's frame. `start_poses`
/// are the poses of links at the task's start. Precondition: check_task() accepts the task.
[[nodiscard]] std::vector<Transform> link_targets(const World& world, const PoseChoice& choice,
                                                  const std::vector<Transform>& start_poses);

}  // namespace mneme::internal
