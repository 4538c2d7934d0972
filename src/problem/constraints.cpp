// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/constraints.h"

#include "scene/shape_fields.h"

#include <string>
#include <utility>

namespace mneme::internal {
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
  constraint.angle = input.at("angle").finite_number();
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
