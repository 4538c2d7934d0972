// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/moveit_request.h"

#include <fmt/format.h>

#include <array>

namespace mneme::internal {
namespace {

constexpr std::array<std::string_view, 3> kOtherConstraints = {
    "position_constraints", "orientation_constraints", "visibility_constraints"};

void refuse_other_constraints(const Input& constraints, std::string_view what) {
  for (const std::string_view key : kOtherConstraints) {
    if (!items_if_any(constraints, key).empty()) {
      constraints.at(key).fail(ErrorCode::unsupported,
                               fmt::format("{} are not supported; expected {}", key, what));
    }
  }
}

double read_tolerance(const Input& constraint, std::string_view key) {
  const auto tolerance = constraint.find(key);
  if (!tolerance) {
    return 0;
  }
  const double value = tolerance->finite_number();
  if (value < 0) {
    tolerance->fail_expecting("a tolerance of 0 or more");
  }
  return value;
}

std::map<std::string, double> read_goal(const Input& goal) {
  goal.allow_keys({"name", "joint_constraints", "position_constraints", "orientation_constraints",
                   "visibility_constraints"});
  refuse_other_constraints(goal, "a goal of joint_constraints alone");
  std::map<std::string, double> positions;
  for (const Input& constraint : items_if_any(goal, "joint_constraints")) {
    constraint.allow_keys(
        {"joint_name", "position", "tolerance_above", "tolerance_below", "weight"});
    const double centre = constraint.at("position").finite_number() +
                          0.5 * (read_tolerance(constraint, "tolerance_above") -
                                 read_tolerance(constraint, "tolerance_below"));
    const Input joint = constraint.at("joint_name");
    if (!positions.emplace(joint.text(), centre).second) {
      joint.fail(ErrorCode::parse,
                 fmt::format("expected each joint once, got {} again", joint.text()));
    }
  }
  if (positions.empty()) {
    goal.fail(ErrorCode::parse, "expected joint_constraints, got none");
  }
  return positions;
}

void refuse_path_constraints(const Input& input) {
  const auto path = input.find("path_constraints");
  if (path && !path->is_nothing()) {
    refuse_other_constraints(*path, "a path without constraints");
    if (!items_if_any(*path, "joint_constraints").empty()) {
      path->fail(ErrorCode::unsupported,
                 "joint_constraints are not supported here; expected a path without constraints");
    }
  }
  const auto trajectory = input.find("trajectory_constraints");
  if (trajectory && !trajectory->is_nothing() &&
      !items_if_any(*trajectory, "constraints").empty()) {
    trajectory->fail(ErrorCode::unsupported,
                     "trajectory_constraints are not supported; expected none");
  }
}

}  // namespace

bool is_moveit_request(const Input& input) {
  return input.is_map() &&
         (input.find("goal_constraints") || input.find("start_state") || input.find("group_name"));
}

MoveitRequest read_moveit_request(const Input& input) {
  input.allow_keys({"workspace_parameters", "start_state", "goal_constraints", "path_constraints",
                    "trajectory_constraints", "reference_trajectories", "pipeline_id", "planner_id",
                    "group_name", "num_planning_attempts", "allowed_planning_time",
                    "max_velocity_scaling_factor", "max_acceleration_scaling_factor",
                    "cartesian_speed_limited_link", "cartesian_speed_end_effector_link",
                    "max_cartesian_speed"});
  refuse_path_constraints(input);
  MoveitRequest request;
  if (const auto group = input.find("group_name"); group && !group->is_nothing()) {
    request.group = group->text();
  }
  if (const auto start = input.find("start_state"); start && !start->is_nothing()) {
    request.start = read_moveit_state(*start);
  }
  request.goal_places = input.at("goal_constraints").items();
  for (const Input& goal : request.goal_places) {
    request.goals.push_back(read_goal(goal));
  }
  if (request.goals.empty()) {
    input.at("goal_constraints").fail_expecting("at least one goal");
  }
  return request;
}

}  // namespace mneme::internal
