// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "check/solid_pair.h"

#include "base/as_index.h"
#include "robot/kinematics.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <utility>

namespace mneme::internal {

JointChain::JointChain(const Robot& robot, int a, std::optional<int> b) {
  std::vector<int> up = joints_to(robot, a);
  std::vector<int> down = b ? joints_to(robot, *b) : std::vector<int>();
  while (!up.empty() && !down.empty() && up.back() == down.back()) {
    up.pop_back();
    down.pop_back();
  }
  for (const int joint : up) {
    add_motion(robot, joint, -1);
    last_ = last_ * robot.joints()[as_index(joint)].origin.inverse();
  }
  std::ranges::reverse(down);
  for (const int joint : down) {
    last_ = last_ * robot.joints()[as_index(joint)].origin;
    add_motion(robot, joint, 1);
  }
}

void JointChain::add_motion(const Robot& robot, int index, double sign) {
  const Joint& joint = robot.joints()[as_index(index)];
  const auto drive = find_drive(robot, index);
  if (!drive) {
    const Transform still = joint_motion(joint, joint.fixed_value);
    last_ = last_ * (sign > 0 ? still : still.inverse());
    return;
  }
  const Transform to_axis{
      Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), joint.axis).toRotationMatrix(),
      Vec3::Zero()};
  steps_.push_back({last_ * to_axis, joint.type == JointType::prismatic, drive->joint,
                    sign * drive->rate, sign * drive->offset});
  last_ = to_axis.inverse();
}

ChainMotion::ChainMotion(const JointChain& chain, std::span<const float> from,
                         std::span<const float> delta)
    : chain_(chain), from_(from), delta_(delta) {
  if (!delta.empty()) set_bounds();
  const bool moves = of_b.speed > 0 || of_b.speed_by_reach > 0;
  const double half = moves ? 0.5 : 0;
  add_interval(half, half);
}

double ChainMotion::rate_of(const Step& step) const {
  return delta_.empty() ? 0 : step.rate * delta_[as_index(step.joint)];
}

double ChainMotion::value_of(const Step& step, double share) const {
  return step.rate * from_[as_index(step.joint)] + step.offset + share * rate_of(step);
}

MovingPose ChainMotion::at(double share) const {
  MovingPose result;
  Transform& X = result.X_AB;
  for (const Step& step : chain_.steps()) {
    X = X * step.mount;
    const Vec3 axis = X.rotation.col(2);
    const double value = value_of(step, share), rate = rate_of(step);
    if (step.is_prismatic) {
      X.translation += value * axis;
      result.speed += rate * axis;
      continue;
    }
    const double c = std::cos(value), s = std::sin(value);
    const Vec3 x = X.rotation.col(0), y = X.rotation.col(1);
    X.rotation.col(0) = c * x + s * y;
    X.rotation.col(1) = c * y - s * x;
    result.turn += rate * axis;
    result.speed -= rate * axis.cross(X.translation);
  }
  X = X * chain_.last();
  result.speed += result.turn.cross(X.translation);
  return result;
}

/// A point's distance from a joint is at most its reach and the length of the chain in between.
/// Its acceleration is the sum of |q_i' q_j'| |z_i x (z_j x r_j)| over pairs of joints, j nearer
/// to it.
void ChainMotion::set_bounds() {
  const std::span<const Step> steps = chain_.steps();
  double all_turns = 0;
  for (const Step& step : steps) all_turns += step.is_prismatic ? 0 : std::abs(rate_of(step));
  double length = chain_.last().translation.norm(), turns = all_turns;
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
    add(*step, length, turns, of_b);
    length += step->mount.translation.norm();
  }
  length = 0;
  turns = all_turns;
  for (const Step& step : steps) {
    length += step.mount.translation.norm();
    add(step, length, turns, of_a);
  }
}

/// Adds a joint, beyond which the chain has `length` metres towards the point. `turns` are those
/// of this joint and of the others towards the observer.
void ChainMotion::add(const Step& step, double& length, double& turns, MotionBound& bound) const {
  const double rate = std::abs(rate_of(step));
  if (step.is_prismatic) {
    bound.speed += rate;
    bound.bend += 2 * turns * rate;
    length += std::max(std::abs(value_of(step, 0)), std::abs(value_of(step, 1)));
    return;
  }
  const double bend = rate * (2 * turns - rate);
  turns -= rate;
  bound.speed += rate * length;
  bound.speed_by_reach += rate;
  bound.bend += bend * length;
  bound.bend_by_reach += bend;
}

namespace {

std::vector<SweptSolid> solids_of(const ExactLink& link) {
  std::vector<SweptSolid> solids;
  if (!link.shapes().empty()) solids.emplace_back(link.shapes());
  for (const Mesh& surface : link.surfaces()) solids.emplace_back(surface);
  return solids;
}

}  // namespace

SolidPair::SolidPair(JointChain chain_to_other, ExactLink first, ExactLink second)
    : chain(std::move(chain_to_other)),
      link(std::move(first)),
      other(std::move(second)),
      solids(solids_of(link)),
      others(solids_of(*other)) {}

SolidPair::SolidPair(JointChain chain_to_shapes, ExactLink first, std::vector<Shape> their_shapes,
                     double their_margin)
    : chain(std::move(chain_to_shapes)),
      link(std::move(first)),
      shapes(std::move(their_shapes)),
      solids(solids_of(link)),
      others(shapes.begin(), shapes.end()),
      margin(their_margin) {}

template <class AreApart>
bool SolidPair::all_pairs(const AreApart& are_apart) const {
  return std::ranges::all_of(solids, [&](const SweptSolid& solid) {
    return std::ranges::all_of(others,
                               [&](const SweptSolid& theirs) { return are_apart(solid, theirs); });
  });
}

/// True unless it is proven that nothing is inside a surface of the pair.
bool SolidPair::may_be_inside(const Transform& X_AB) const {
  if (other) return link.may_enclose(*other, X_AB) || other->may_enclose(link, X_AB.inverse());
  return std::ranges::any_of(
      shapes, [&](const Shape& shape) { return link.may_enclose(transformed(X_AB, shape)); });
}

bool SolidPair::stays_apart(ChainMotion& motion, double extra) const {
  // Surfaces that never meet enclose the same on the whole motion.
  return is_apart_at_states(motion, extra, 0) && !may_be_inside(motion.interval(0).pose.X_AB);
}

bool SolidPair::stays_apart_as_whole(ChainMotion& motion, double extra) const {
  return all_pairs([&](const SweptSolid& solid, const SweptSolid& theirs) {
           return internal::stay_apart_as_whole(solid, theirs, motion, margin + extra);
         }) &&
         !may_be_inside(motion.interval(0).pose.X_AB);
}

bool SolidPair::is_apart_at_states(ChainMotion& motion, double extra, double finest) const {
  return all_pairs([&](const SweptSolid& solid, const SweptSolid& theirs) {
    return internal::stay_apart(solid, theirs, motion, margin + extra, finest);
  });
}

}  // namespace mneme::internal
