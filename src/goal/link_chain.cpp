// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "goal/link_chain.h"

#include "base/as_index.h"
#include "base/fail.h"
#include "robot/kinematics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

namespace mneme::internal {
namespace {

using Square = Eigen::Matrix<double, 6, 6>;

/// Joint motions are rated less within this distance of a limit, radians.
constexpr double kLimitRoom = 0.6;
constexpr double kLeastWeight = 0.08;
/// Largest motion of a joint in one step of Newton's method.
constexpr double kLongestStep = 0.5;
/// Rotations may be off by this many radians per metre.
constexpr double kRadiansPerMetre = 3;

/// Joints between root and link, with those that follow others.
constexpr std::size_t kMostSteps = 2 * kMostChainJoints;

double cube(double x) { return x * x * x; }

}  // namespace

Twist difference(const Transform& from, const Transform& to) {
  Twist twist;
  twist.head<3>() = to.translation - from.translation;
  const Eigen::Matrix3d turn = to.rotation * from.rotation.transpose();
  const Vec3 axis(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1));
  const double sine = axis.norm() / 2, cosine = (turn.trace() - 1) / 2;
  const double scale = sine > 1e-9 ? std::atan2(sine, cosine) / (2 * sine) : 0.5;
  twist.tail<3>() = scale * axis;
  return twist;
}

Result<LinkChain> LinkChain::make(const Robot& robot, const std::string& link,
                                  std::optional<Axis> free_axis) {
  const auto found = robot.find_link(link);
  if (!found) {
    return fail(ErrorCode::invalid, "expected a link of robot {}, got \"{}\"", robot.name(), link);
  }
  LinkChain chain;
  std::vector<int> joints = joints_to(robot, *found);
  std::ranges::reverse(joints);
  std::set<int> moving;
  Transform fixed;
  for (const int index : joints) {
    const Joint& joint = robot.joints()[as_index(index)];
    fixed = fixed * joint.origin;
    const auto drive = joint.type == JointType::fixed ? std::nullopt : find_drive(robot, index);
    if (!drive) {
      fixed = fixed * joint_motion(joint, joint.fixed_value);
      continue;
    }
    fixed = chain.add_step(
        fixed, joint.axis,
        {{}, drive->joint, drive->rate, drive->offset, joint.type == JointType::prismatic});
    moving.insert(drive->joint);
  }
  const int extra = free_axis ? 1 : 0, count = robot.joint_count() + extra;
  const int moving_count = static_cast<int>(moving.size());
  constexpr int kLeastJoints = 6;
  if (moving_count + extra < kLeastJoints || count > kMostChainJoints ||
      chain.steps_.size() + as_index(extra) > kMostSteps) {
    return fail(ErrorCode::unsupported,
                "{} of {} joints of robot {} move link \"{}\"; cells and lines need at least {} "
                "that do, and a group of at most {} joints",
                moving_count, robot.joint_count(), robot.name(), link, kLeastJoints - extra,
                kMostChainJoints - extra);
  }
  if (free_axis) {
    fixed = chain.add_step(fixed, Vec3::Unit(static_cast<int>(*free_axis)),
                           {{}, robot.joint_count(), 1, 0, false});
  }
  chain.tip_ = fixed;
  chain.moving_count_ = moving_count + extra;
  chain.set_limits(robot, count);
  return chain;
}

void LinkChain::set_limits(const Robot& robot, int count) {
  constexpr double kUnlimited = std::numeric_limits<double>::infinity();
  lower_.setConstant(count, -kUnlimited);
  upper_.setConstant(count, kUnlimited);
  wraps_.assign(as_index(count), true);
  for (int j = 0; j < robot.joint_count(); ++j) {
    const Joint& joint = robot.group_joint(j);
    if (joint.type == JointType::continuous) continue;
    wraps_[as_index(j)] = false;
    lower_[j] = joint.lower;
    upper_[j] = joint.upper;
  }
}

Transform LinkChain::add_step(const Transform& fixed, const Vec3& axis, Step step) {
  const Eigen::Matrix3d to_axis =
      Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), axis).toRotationMatrix();
  step.fixed = fixed * Transform{to_axis, Vec3::Zero()};
  steps_.push_back(step);
  return {to_axis.transpose(), Vec3::Zero()};
}

Transform LinkChain::place(const JointVector& q, Jacobian* jacobian) const {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  Vec3 origin = Vec3::Zero();
  std::array<Vec3, kMostSteps> origins, axes;
  const std::size_t count = steps_.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Step& step = steps_[i];
    origin += turn * step.fixed.translation;
    turn = turn * step.fixed.rotation;
    axes[i] = turn.col(2);
    const double value = step.rate * q[step.joint] + step.offset;
    if (step.is_prismatic) {
      origin += value * axes[i];
    } else {
      const double cosine = std::cos(value), sine = std::sin(value);
      const Vec3 x = turn.col(0), y = turn.col(1);
      turn.col(0) = cosine * x + sine * y;
      turn.col(1) = cosine * y - sine * x;
    }
    origins[i] = origin;
  }
  const Transform pose{turn * tip_.rotation, origin + turn * tip_.translation};
  if (jacobian == nullptr) return pose;
  jacobian->setZero(6, joint_count());
  for (std::size_t i = 0; i < count; ++i) {
    const Step& step = steps_[i];
    auto column = jacobian->col(step.joint);
    if (step.is_prismatic) {
      column.head<3>() += step.rate * axes[i];
    } else {
      column.head<3>() += step.rate * axes[i].cross(pose.translation - origins[i]);
      column.tail<3>() += step.rate * axes[i];
    }
  }
  return pose;
}

Response LinkChain::response(const JointVector& q) const {
  Jacobian jacobian;
  (void)place(q, &jacobian);
  return response(q, jacobian, 0, 0);
}

Response LinkChain::response(const JointVector& q, const Jacobian& jacobian, std::uint32_t locked,
                             double damping) const {
  const Response along = directions(q, jacobian, locked);
  Square gram = jacobian * along;
  gram.diagonal().array() += damping;
  return along * gram.inverse();
}

Response LinkChain::directions(const JointVector& q) const {
  Jacobian jacobian;
  (void)place(q, &jacobian);
  return directions(q, jacobian, 0);
}

Response LinkChain::directions(const JointVector& q, const Jacobian& jacobian,
                               std::uint32_t locked) const {
  Response along = jacobian.transpose();
  for (int j = 0; j < joint_count(); ++j) {
    const double room = std::min(q[j] - lower_[j], upper_[j] - q[j]);
    const bool is_locked = (locked >> j & 1) != 0;
    along.row(j) *= is_locked ? 0 : std::clamp(room / kLimitRoom, kLeastWeight, 1.0);
  }
  return along;
}

bool LinkChain::reach(const Transform& pose, const Response& response, int steps, double near,
                      JointVector& q) const {
  Jacobian jacobian;
  for (int i = 0; i <= steps; ++i) {
    const Twist error = difference(place(q, &jacobian), pose);
    if (error.head<3>().norm() < near && error.tail<3>().norm() < kRadiansPerMetre * near) {
      return true;
    }
    const Square gram = jacobian * response;
    JointVector step = response * gram.partialPivLu().solve(error);
    const double longest = step.cwiseAbs().maxCoeff();
    if (!(longest < 1e3)) return false;
    if (longest > kLongestStep) step *= kLongestStep / longest;
    q += step;
  }
  return false;
}

bool LinkChain::approach(const Transform& pose, const Response& response, double near,
                         JointVector& q) const {
  double bound = std::numeric_limits<double>::infinity();
  while (true) {
    const Twist error = difference(place(q), pose);
    const double size = std::max(error.head<3>().norm(), error.tail<3>().norm() / kRadiansPerMetre);
    if (size < near) return true;
    if (!(size < bound)) return false;
    bound = size / 2;
    q += response * error;
  }
}

LinkChain::MotionBounds LinkChain::bounds(const JointVector& from, const JointVector& to) const {
  double turn = 0, jerk = 0;
  for (const Step& step : steps_) {
    jerk += cube(turn) * step.fixed.translation.norm();
    const double rate = std::abs(step.rate * (to[step.joint] - from[step.joint]));
    if (step.is_prismatic) {
      const double longest = std::max(std::abs(step.rate * from[step.joint] + step.offset),
                                      std::abs(step.rate * to[step.joint] + step.offset));
      jerk += cube(turn) * longest + 3 * turn * turn * rate;
    } else {
      turn += rate;
    }
  }
  return {jerk + cube(turn) * tip_.translation.norm(), turn};
}

}  // namespace mneme::internal
