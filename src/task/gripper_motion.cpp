// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "task/gripper_motion.h"

#include "base/as_index.h"
#include "check/parted_pairs.h"
#include "path/waypoints.h"
#include "pipeline/end_exit.h"
#include "planning/end_contacts.h"
#include "robot/kinematics.h"

#include <algorithm>
#include <string>
#include <vector>

namespace mneme::internal {
namespace {

/// States of a motion that leaves or enters contact.
constexpr int kFingerStates = 32;

/// The joints that the stage moves, in the robot's order.
std::vector<const Joint*> moved_joints(const Robot& robot, const Stage& stage) {
  std::vector<const Joint*> moved;
  for (const Joint& joint : robot.joints()) {
    const auto value = stage.values.find(joint.name);
    if (value != stage.values.end() && value->second != joint.fixed_value) moved.push_back(&joint);
  }
  return moved;
}

/// The configuration of the wide robot: `q` of the group, and the values of the other joints.
Configuration widened(const Robot& wide, const Robot& robot, const Configuration& q,
                      const std::map<std::string, double>& values) {
  Configuration all;
  const std::vector<std::string> group = robot.joint_names();
  for (const std::string& name : wide.joint_names()) {
    const auto own = std::ranges::find(group, name);
    if (own != group.end()) {
      all.push_back(q[as_index(static_cast<int>(own - group.begin()))]);
    } else if (const auto value = values.find(name); value != values.end()) {
      all.push_back(value->second);
    } else {
      all.push_back(std::ranges::find(robot.joints(), name, &Joint::name)->fixed_value);
    }
  }
  return all;
}

/// Fingers may close until they touch, and open from there. What they hold has allow-at-ends.
void let_fingers_meet(const Robot& wide, const Robot& robot, Scene& scene) {
  constexpr double kStretch = 0.02;  // metres
  const std::size_t first_held = wide.links().size() - wide.attached().size();
  for (const auto& [first, second] : parted_pairs(wide, robot)) {
    if (as_index(std::max(first, second)) >= first_held) continue;
    scene.end_contacts.push_back(
        {wide.links()[as_index(first)].name, wide.links()[as_index(second)].name, kStretch});
  }
}

/// True per link of the wide robot that joints outside of the group of `robot` carry.
std::vector<bool> find_finger_links(const Robot& wide, const Robot& robot) {
  const std::vector<std::string> own = robot.joint_names();
  std::vector<int> fingers;
  for (const int joint : wide.group()) {
    const std::string& name = wide.joints()[as_index(joint)].name;
    if (std::ranges::count(own, name) == 0) fingers.push_back(joint);
  }
  const std::vector<bool> moves = find_moving(wide.joints(), fingers);
  std::vector<bool> carried;
  for (int link = 0; link < std::ssize(wide.links()); ++link) {
    const auto is_moving = [&](int joint) { return bool{moves[as_index(joint)]}; };
    carried.push_back(std::ranges::any_of(joints_to(wide, link), is_moving));
  }
  return carried;
}

/// Lets all links but the fingers touch what they touch at `q`: they rest, and the stages before
/// and after check these contacts. Returns false if there are none.
bool allow_resting_contacts(const CollisionChecker& checker, const Robot& robot,
                            const Configuration& q, Scene& scene) {
  const Robot& wide = checker.robot();
  const std::vector<bool> is_finger = find_finger_links(wide, robot);
  bool has_any = false;
  for (const Contact& contact : checker.contacts(wide.normalized(q))) {
    if (contact.is_self || is_finger[as_index(*wide.find_link(contact.link))]) continue;
    scene.find(contact.other)->may_touch.push_back(contact.link);
    has_any = true;
  }
  return has_any;
}

/// The checker of the wide robot for a motion of the fingers while the group rests.
Result<QueryChecker> make_finger_checker(const TaskRun& run, const CheckedWorld& world,
                                         const Robot& wide, const PlanQuery& motion) {
  const Robot& robot = world.world.robot;
  Scene scene = world.checker.scene();
  let_fingers_meet(wide, robot, scene);
  QueryChecker checked = MNEME_TRY(make_query_checker(wide, scene, run.checker_settings(), motion));
  if (checked.are_ends_clear ||
      !allow_resting_contacts(checked.checker, robot, motion.start, scene)) {
    return checked;
  }
  return make_query_checker(wide, scene, run.checker_settings(), motion);
}

bool is_motion_clear(const CollisionChecker& checker, const Configuration& from,
                     const Configuration& to) {
  const Robot& robot = checker.robot();
  CheckCounters counters;
  return is_clear(checker, from) &&
         checker.is_sweep_valid(to_floats(robot, from), to_floats(robot, to), counters,
                                {.margin = kVerificationMargin});
}

/// True if the motion only leaves contact at its start, or only enters contact at its end.
bool is_only_in_contact_at_an_end(const TaskRun& run, const CollisionChecker& checker,
                                  const Configuration& from, const Configuration& to) {
  for (const PathEnd end : {PathEnd::goal, PathEnd::start}) {
    EndExit exit(checker, end_tolerances(run.settings.solve), end, kFingerStates);
    const bool is_start = end == PathEnd::start;
    const Configuration &q = is_start ? from : to, &inside = is_start ? to : from;
    if (exit.may_leave(exit.find_touches(q, kSolidClearance)) && exit.is_left_by(q, inside))
      return true;
  }
  return false;
}

std::string describe_blocked(const CollisionChecker& checker, const Configuration& from,
                             const Configuration& to) {
  constexpr int kSteps = 32;
  for (int i = 1; i <= kSteps; ++i) {
    Configuration q = from;
    for (std::size_t j = 0; j < q.size(); ++j) q[j] += (to[j] - from[j]) * i / kSteps;
    if (!is_clear(checker, q)) return describe_contact(checker, q) + " while the gripper moves";
  }
  return "too near to something while the gripper moves";
}

}  // namespace

tl::expected<GripperMotionPtr, Failure> move_gripper(TaskRun& run, const CheckedWorld& world,
                                                     const Stage& stage, const Configuration& q) {
  const Robot& robot = world.world.robot;
  if (moved_joints(robot, stage).empty()) return nullptr;
  const auto invalid = [](const Error& error) {
    return tl::unexpected(Failure{DropReason::world, error.message});
  };
  const auto wide = find_or_make_wide(world.world, stage.values);
  if (!wide) return invalid(wide.error());
  const Configuration from = widened(*wide, robot, q, {});
  const Configuration to = widened(*wide, robot, q, stage.values);
  const auto checked = make_finger_checker(run, world, *wide, {from, {to}});
  if (!checked) return invalid(checked.error());
  const CollisionChecker& checker = checked->checker;
  run.states += kFingerStates;
  const bool may_touch =
      run.may_touch_at_ends(world.world) || !checker.scene().end_contacts.empty();
  const bool is_free = is_motion_clear(checker, from, to) ||
                       (may_touch && is_only_in_contact_at_an_end(run, checker, from, to));
  if (!is_free) {
    return tl::unexpected(Failure{DropReason::contact, describe_blocked(checker, from, to)});
  }
  Problem world_of_fingers{.name = run.task.name,
                           .robot = *wide,
                           .robot_path = run.task.robot_path,
                           .scene = checker.scene(),
                           .start = from,
                           .goals = {to}};
  return std::make_shared<const GripperMotion>(
      GripperMotion{std::make_shared<const Problem>(std::move(world_of_fingers)), {from, to}});
}

}  // namespace mneme::internal
