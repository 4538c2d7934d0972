// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "check/cones.h"

#include "base/as_index.h"
#include "robot/kinematics.h"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mneme::internal {
namespace {

/// A stretch that turns less, in radians, and is not proven inside counts as outside.
constexpr double kFinestTurn = 1e-3;
/// Projections aim at this share of the cone's angle, so that motions between them have room.
constexpr double kDepth = 0.8;
constexpr int kMostSteps = 20;
constexpr double kMostStep = 0.5;  ///< radians
constexpr double kDamping = 1e-3;

Vec3 turned(const Vec3& axis, double angle, const Vec3& v) {
  const double c = std::cos(angle), s = std::sin(angle);
  return c * v + s * axis.cross(v) + (1 - c) * axis.dot(v) * axis;
}

}  // namespace

Cone::Cone(const Robot& robot, const OrientationConstraint& constraint)
    : up_(constraint.up), angle_(constraint.angle) {
  Eigen::Matrix3d before = Eigen::Matrix3d::Identity();
  std::vector<int> joints = joints_to(robot, *robot.find_link(constraint.link));
  std::ranges::reverse(joints);
  for (const int i : joints) {
    const Joint& joint = robot.joints()[as_index(i)];
    before = before * joint.origin.rotation;
    if (!is_turning(joint)) continue;
    const auto drive = find_drive(robot, i);
    if (!drive) {
      before = before * rotation_about(joint.axis, joint.fixed_value);
      continue;
    }
    turns_.push_back({before, joint.axis, drive->joint, drive->rate, drive->offset});
    before = Eigen::Matrix3d::Identity();
  }
  axis_ = before * constraint.axis;
}

double Cone::cosine(const float* from, const float* delta, double share) const {
  Vec3 v = axis_;
  for (auto turn = turns_.rbegin(); turn != turns_.rend(); ++turn) {
    const auto j = as_index(turn->joint);
    const double value = from[j] + (delta == nullptr ? 0 : share * delta[j]);
    v = turn->before * turned(turn->axis, turn->rate * value + turn->offset, v);
  }
  return v.dot(up_);
}

double Cone::cosine_and_gradient(const float* q, std::span<double> gradient) const {
  std::vector<Vec3> axes(turns_.size());  // after each turn, in its frame
  Vec3 v = axis_;
  for (std::size_t i = turns_.size(); i-- > 0;) {
    const Turn& turn = turns_[i];
    axes[i] = turned(turn.axis, turn.rate * q[as_index(turn.joint)] + turn.offset, v);
    v = turn.before * axes[i];
  }
  Vec3 up = up_;  // in the frame of each turn
  for (std::size_t i = 0; i < turns_.size(); ++i) {
    const Turn& turn = turns_[i];
    up = turn.before.transpose() * up;
    gradient[as_index(turn.joint)] += turn.rate * up.dot(turn.axis.cross(axes[i]));
    up = turned(turn.axis, -(turn.rate * q[as_index(turn.joint)] + turn.offset), up);
  }
  return v.dot(up_);
}

double Cone::longest_turn(const float* delta) const {
  double sum = 0;
  for (const Turn& turn : turns_) sum += std::abs(turn.rate * delta[as_index(turn.joint)]);
  return sum;
}

bool Cone::contains_motion(const float* from, const float* delta, double slack) const {
  const double allowed = angle_ - kTiltMargin - slack;
  if (allowed >= std::numbers::pi) return true;
  if (allowed < 0) return false;
  const double least = std::cos(allowed), longest = longest_turn(delta);
  struct Stretch {
    double begin, end, above_begin, above_end;
  };
  const auto above = [&](double share) { return cosine(from, delta, share) - least; };
  std::vector<Stretch> rest = {{0, 1, above(0), above(1)}};
  while (!rest.empty()) {
    const Stretch s = rest.back();
    rest.pop_back();
    if (s.above_begin < 0 || s.above_end < 0) return false;
    const double turn = longest * (s.end - s.begin), bend = 0.5 * turn * turn;
    const double excess = s.above_begin + bend - s.above_end;
    const bool has_inner_least = excess > 0 && excess < 2 * bend;
    if (!has_inner_least || 4 * bend * s.above_begin >= excess * excess) continue;
    if (turn < kFinestTurn) return false;
    const double middle = 0.5 * (s.begin + s.end), above_middle = above(middle);
    rest.push_back({s.begin, middle, s.above_begin, above_middle});
    rest.push_back({middle, s.end, above_middle, s.above_end});
  }
  return true;
}

Cones::Cones(const Robot& robot, std::span<const OrientationConstraint> constraints)
    : space_(robot), constraints_(constraints.begin(), constraints.end()) {
  for (const OrientationConstraint& constraint : constraints)
    cones_.emplace_back(robot, constraint);
}

bool Cones::contain(std::span<const float> q) const {
  return std::ranges::all_of(cones_, [&](const Cone& cone) {
    return cone.angle() - kTiltMargin >= std::numbers::pi ||
           cone.cosine(q.data()) >= std::cos(cone.angle() - kTiltMargin);
  });
}

bool Cones::contain_motion(std::span<const float> from, std::span<const float> to,
                           std::span<const float> bow) const {
  if (cones_.empty()) return true;
  std::vector<float> delta(from.size());
  space_.difference(from.data(), to.data(), delta.data());
  return std::ranges::all_of(cones_, [&](const Cone& cone) {
    const double slack = bow.empty() ? 0 : cone.longest_turn(bow.data());
    return cone.contains_motion(from.data(), delta.data(), slack);
  });
}

bool Cones::project(std::span<float> q) const {
  if (contain(q)) return true;
  std::vector<float> led(q.begin(), q.end());
  for (int step = 0; step < kMostSteps; ++step) {
    for (const Cone& cone : cones_) {
      if (!lean_back(cone, led)) return false;
    }
    if (!contain(led)) continue;
    std::ranges::copy(led, q.begin());
    return true;
  }
  return false;
}

bool Cones::lean_back(const Cone& cone, std::span<float> q) const {
  std::vector<double> gradient(q.size());
  const double cosine = std::clamp(cone.cosine_and_gradient(q.data(), gradient), -1.0, 1.0);
  const double leaning = std::acos(cosine), inside = kDepth * cone.angle();
  if (leaning <= inside) return true;
  const double sine = std::sqrt(1 - cosine * cosine);
  double square = 0;  // of the tilt's gradient
  for (double& slope : gradient) {
    slope /= -sine;
    square += slope * slope;
  }
  if (!std::isfinite(square) || square < kDamping * kDamping) return false;
  const double step = std::max(inside - leaning, -kMostStep) / (square + kDamping);
  for (std::size_t j = 0; j < q.size(); ++j) {
    const double value = q[j] + step * gradient[j];
    q[j] = space_.into_limits(static_cast<int>(j), static_cast<float>(value));
  }
  return true;
}

}  // namespace mneme::internal

namespace mneme {

std::optional<std::string> describe_fault(const Robot& robot,
                                          const OrientationConstraint& constraint) {
  constexpr double kUnitTolerance = 1e-6;
  const auto link = robot.find_link(constraint.link);
  if (!link) {
    return fmt::format("expected a link of robot {}, got \"{}\"", robot.name(), constraint.link);
  }
  const auto is_turned = [&](int joint) {
    return internal::is_turning(robot.joints()[internal::as_index(joint)]) &&
           internal::find_drive(robot, joint);
  };
  if (std::ranges::none_of(internal::joints_to(robot, *link), is_turned)) {
    return fmt::format("no joint of the planning group turns link \"{}\"", constraint.link);
  }
  for (const Vec3& direction : {constraint.axis, constraint.up}) {
    if (std::abs(direction.norm() - 1) <= kUnitTolerance) continue;
    return fmt::format("expected directions of unit length, got one of {:.6g}", direction.norm());
  }
  if (!(constraint.angle >= kLeastTilt)) {
    return fmt::format("expected an angle of {} rad or more, got {}", kLeastTilt, constraint.angle);
  }
  return std::nullopt;
}

}  // namespace mneme
