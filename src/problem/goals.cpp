// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/as_index.h"
#include "base/fail.h"
#include "geometry/solids.h"
#include "geometry/tolerated.h"
#include "problem/problem_input.h"
#include "robot/kinematics.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace mneme::internal {
namespace {

Configuration read_joint_map(const Input& input, const Robot& robot) {
  const std::vector<std::string> names = robot.joint_names();
  Configuration q(names.size());
  std::vector<bool> is_given(names.size(), false);
  for (const auto& [name, value] : input.entries()) {
    const auto joint = std::ranges::find(names, name) - names.begin();
    if (joint == std::ssize(names)) {
      value.fail(ErrorCode::invalid, "expected a joint of the planning group ({}), got \"{}\"",
                 fmt::join(names, ", "), name);
    }
    q[as_index(joint)] =
        value.taking_angles(is_turning(robot.group_joint(static_cast<int>(joint)))).number();
    is_given[as_index(joint)] = true;
  }
  const auto missing = std::ranges::find(is_given, false) - is_given.begin();
  if (missing < std::ssize(names)) {
    input.fail(ErrorCode::invalid,
               "expected a value of each joint of the planning group, got none of {}",
               names[as_index(missing)]);
  }
  return q;
}

Eigen::Matrix3d read_unit_quaternion(const Input& input) {
  const std::vector<double> xyzw = input.finite_numbers(4, "a quaternion as x, y, z, w");
  return input.take(rotation_from_unit_quaternion(std::span(xyzw).first<4>()));
}

Vec3 read_position_tolerance(const Input& input) {
  if (!input.is_list()) return Vec3::Constant(input.finite_number());
  return read_point(input);
}

/// Radians, or "free" for any angle.
double read_angle(const Input& input) {
  if (input.is_text() && input.text() == "free") return std::numbers::pi;
  return input.taking_angles().finite_number();
}

Axis read_axis(const Input& input) {
  const auto axis = parse_axis(input.is_text() ? input.text() : "");
  if (!axis) input.fail_expecting("x, y or z");
  return *axis;
}

/// Returns the goal with its pose, in its own frame or in the frame at `X_RF`, converted to the
/// root link's.
PoseGoal placed(const Input& place, PoseGoal goal, const Transform& X_RF, const Problem& problem) {
  if (goal.frame.empty()) {
    goal.pose = X_RF * goal.pose;
    return goal;
  }
  return place.take(in_root_frame(std::move(goal), problem.robot, problem.start));
}

PoseGoal read_pose_goal(const Input& input, const Transform& X_RF, const Problem& problem) {
  input.allow_keys(
      {"link", "frame", "position", "quat_xyzw", "position_tolerance", "axis", "cone", "turn"});
  PoseGoal goal;
  goal.link = input.at("link").text();
  goal.pose.translation = read_point(input.at("position"));
  const auto quaternion = input.find("quat_xyzw");
  if (quaternion) {
    goal.pose.rotation = read_unit_quaternion(*quaternion);
  } else {
    goal.cone = goal.turn = std::numbers::pi;
  }
  const auto frame = input.find("frame");
  if (frame) goal.frame = frame->text();
  if (frame && goal.frame.empty()) frame->fail_expecting("the name of a link");
  goal = placed(frame.value_or(input), std::move(goal), X_RF, problem);
  if (const auto tolerance = input.find("position_tolerance")) {
    goal.position_tolerance = read_position_tolerance(*tolerance);
  }
  if (const auto axis = input.find("axis")) goal.axis = read_axis(*axis);
  for (const auto& [key, angle] : {std::pair("cone", &goal.cone), std::pair("turn", &goal.turn)}) {
    const auto tolerance = input.find(key);
    if (!tolerance) continue;
    if (!quaternion) tolerance->fail(ErrorCode::parse, "expected the key quat_xyzw, too");
    *angle = read_angle(*tolerance);
  }
  return goal;
}

}  // namespace

Configuration read_configuration(const Input& input, const Robot& robot) {
  if (input.is_map()) return read_joint_map(input, robot);
  if (input.is_number()) {
    input.fail_expecting("a list of values, a map from joints to values or the name of a state");
  }
  if (input.is_text()) return input.take(robot.configuration_of(input.text()));
  return read_joint_values(input, robot);
}

std::vector<double> read_joint_values(const Input& list, const Robot& robot) {
  std::vector<double> values = list.taking_angles().numbers();
  for (int i = 0; i < std::min(robot.joint_count(), static_cast<int>(values.size())); ++i) {
    if (is_turning(robot.group_joint(i))) continue;
    static_cast<void>(list.items()[as_index(i)].number());  // refuses an angle
  }
  return values;
}

Configuration read_configuration(const GivenConfiguration& given, const std::string& what,
                                 const Robot& robot) {
  const InputValue nothing;
  return Input(nothing, what).take(robot.configuration_of(given));
}

void add_pose_goal(const Input& place, PoseGoal goal, Problem& problem) {
  if (const auto fault = describe_fault(problem.robot, goal)) {
    place.fail(ErrorCode::invalid, *fault);
  }
  problem.pose_goals.push_back(std::move(goal));
}

void read_goal(const Input& input, const Transform& X_RF, Problem& problem) {
  if (input.is_map() && input.find("link")) {
    add_pose_goal(input, read_pose_goal(input, X_RF, problem), problem);
  } else {
    problem.goals.push_back(read_configuration(input, problem.robot));
  }
}

bool take_goals(const ProblemOptions& options, const Transform& X_RF, Problem& problem) {
  if (options.goal) {
    problem.goals.push_back(read_configuration(*options.goal, "goal", problem.robot));
  }
  const InputValue nothing;
  const std::string source = "goal pose";
  const Input place(nothing, source);
  for (const PoseGoal& goal : options.pose_goals) {
    add_pose_goal(place, placed(place, goal, X_RF, problem), problem);
  }
  return options.goal || !options.pose_goals.empty();
}

namespace {

Vec3 read_direction(const Input& input) {
  const Vec3 direction = read_point(input);
  if (!(direction.norm() > 0)) input.fail_expecting("a direction other than 0");
  return direction.normalized();
}

OrientationConstraint read_constraint(const Input& input, const Transform& X_RF) {
  input.allow_keys({"link", "axis", "up", "angle"});
  OrientationConstraint constraint;
  constraint.link = input.at("link").text();
  if (const auto axis = input.find("axis")) constraint.axis = read_direction(*axis);
  if (const auto up = input.find("up")) constraint.up = read_direction(*up);
  constraint.up = X_RF.rotation * constraint.up;
  constraint.angle = input.at("angle").taking_angles().finite_number();
  return constraint;
}

}  // namespace

void read_constraints(const Input& problem_input, const Transform& X_RF, Problem& problem) {
  const auto constraints = problem_input.find("constraints");
  if (!constraints) return;
  for (const Input& input : constraints->items()) {
    add_constraint(input, read_constraint(input, X_RF), problem);
  }
}

void take_constraints(const ProblemOptions& options, const Transform& X_RF, Problem& problem) {
  const InputValue nothing;
  const std::string source = "constraint";
  for (OrientationConstraint constraint : options.constraints) {
    constraint.up = X_RF.rotation * constraint.up;
    add_constraint(Input(nothing, source), std::move(constraint), problem);
  }
}

void add_constraint(const Input& place, OrientationConstraint constraint, Problem& problem) {
  if (const auto fault = describe_fault(problem.robot, constraint)) {
    place.fail(ErrorCode::invalid, *fault);
  }
  problem.constraints.push_back(std::move(constraint));
}

}  // namespace mneme::internal

namespace mneme {
namespace {

using internal::as_index;

/// Permutes the columns of `rotation` so that `axis` becomes the last.
Eigen::Matrix3d along_axis(const Eigen::Matrix3d& rotation, Axis axis) {
  Eigen::Matrix3d permuted;
  for (int k = 0; k < 3; ++k) permuted.col(k) = rotation.col((static_cast<int>(axis) + 1 + k) % 3);
  return permuted;
}

tl::unexpected<Error> refuse_length(double length) {
  return fail(ErrorCode::invalid, "expected a quaternion of length 1, got one of length {:.6g}",
              length);
}

}  // namespace

std::optional<Axis> parse_axis(std::string_view name) {
  for (const Axis axis : {Axis::x, Axis::y, Axis::z}) {
    if (name == to_string(axis)) return axis;
  }
  return std::nullopt;
}

std::string_view to_string(Axis axis) {
  return std::string_view("xyz").substr(static_cast<std::size_t>(axis), 1);
}

Result<ScaledRotation> rotation_from_scaled_quaternion(std::span<const double, 4> xyzw) {
  const auto [x, y, z, w] = std::array{xyzw[0], xyzw[1], xyzw[2], xyzw[3]};
  const double length = std::hypot(std::hypot(x, y), std::hypot(z, w));
  const auto judgement = internal::judge_length({x, y, z, w});
  if (judgement == internal::QuaternionLength::wrong) return refuse_length(length);
  return ScaledRotation{rotation_from_quaternion(w, x, y, z), length,
                        judgement == internal::QuaternionLength::tolerated};
}

Result<Eigen::Matrix3d> rotation_from_unit_quaternion(std::span<const double, 4> xyzw) {
  const ScaledRotation scaled = MNEME_TRY(rotation_from_scaled_quaternion(xyzw));
  if (scaled.is_scaled) return refuse_length(scaled.length);
  return scaled.rotation;
}

PoseError pose_error(const Robot& robot, const PoseGoal& goal, std::span<const double> q) {
  const Transform X_RL = robot.link_poses(q)[as_index(*robot.find_link(goal.link))];
  const Vec3 off = goal.pose.inverse() * X_RL.translation;
  const Vec3 beyond = (off.cwiseAbs() - goal.position_tolerance).cwiseMax(0);
  // The remaining rotation, as a lean of the axis after a turn about it.
  const Eigen::Matrix3d left =
      along_axis(goal.pose.rotation, goal.axis).transpose() * along_axis(X_RL.rotation, goal.axis);
  const double lean = std::atan2(std::hypot(left(0, 2), left(1, 2)), left(2, 2));
  const double turn = std::abs(std::atan2(left(1, 0) - left(0, 1), left(0, 0) + left(1, 1)));
  return {beyond.norm(), std::max({0.0, lean - goal.cone, turn - goal.turn})};
}

Result<PoseGoal> in_root_frame(PoseGoal goal, const Robot& robot, std::span<const double> q) {
  if (goal.frame.empty()) return goal;
  const auto link = robot.find_frame(goal.frame);
  if (!link) {
    return fail(ErrorCode::invalid, "expected a link of robot {}, got \"{}\"", robot.name(),
                goal.frame);
  }
  if (const auto violation = robot.describe_violation(q, "start")) {
    return fail(ErrorCode::invalid, "the pose of link \"{}\" is unknown: {}", goal.frame,
                *violation);
  }
  goal.pose = robot.link_poses(q)[as_index(*link)] * goal.pose;
  goal.frame.clear();
  return goal;
}

std::optional<std::string> describe_fault(const Robot& robot, const PoseGoal& goal) {
  const auto link = robot.find_link(goal.link);
  if (!link) {
    return fmt::format("expected a link of robot {}, got \"{}\"", robot.name(), goal.link);
  }
  if (!internal::find_moving_links(robot)[as_index(*link)]) {
    return fmt::format("no joint of the planning group moves link \"{}\"", goal.link);
  }
  if (!goal.frame.empty()) {
    return fmt::format("expected a pose in the root link's frame, got one in that of link \"{}\"",
                       goal.frame);
  }
  const Eigen::Matrix3d& rotation = goal.pose.rotation;
  if (!goal.pose.translation.allFinite() || !rotation.allFinite()) {
    return fmt::format("expected a pose of link \"{}\" of finite numbers", goal.link);
  }
  if (!(goal.pose.translation.norm() <= kFarthestShape)) {
    return fmt::format("expected a pose of link \"{}\" within {} m of the root link's origin",
                       goal.link, kFarthestShape);
  }
  if (!internal::is_rotation(rotation)) {
    return fmt::format("the rotation for link \"{}\" is invalid: expected orthonormal columns",
                       goal.link);
  }
  if (!(goal.position_tolerance.minCoeff() >= 0) || !goal.position_tolerance.allFinite()) {
    return fmt::format("the region is empty: expected position tolerances of 0 m or more, got {}",
                       fmt::join(goal.position_tolerance, ", "));
  }
  if (!(goal.cone >= 0) || !(goal.turn >= 0)) {
    return fmt::format("the region is empty: expected angles of 0 or more, got cone {} and turn {}",
                       goal.cone, goal.turn);
  }
  return std::nullopt;
}

}  // namespace mneme
