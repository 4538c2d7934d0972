// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "cell/link_chain.h"

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

using Twist = Eigen::Matrix<double, 6, 1>;
using Square = Eigen::Matrix<double, 6, 6>;

/// Joint motions are rated less within this distance of a limit, radians.
constexpr double kLimitRoom = 0.6;
constexpr double kLeastWeight = 0.08;
/// Largest motion of a joint in one step of Newton's method.
constexpr double kLongestStep = 0.5;
/// Rotations may be off by this many radians per metre.
constexpr double kRadiansPerMetre = 3;

/// Joints between root and link, with those that follow others.
constexpr std::size_t kMostSteps = 2 * kMostCellJoints;

/// From one pose to another: motion, then rotation.
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

}  // namespace

Result<LinkChain> LinkChain::make(const Robot& robot, const std::string& link) {
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
    const Eigen::Matrix3d to_axis =
        Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), joint.axis).toRotationMatrix();
    chain.steps_.push_back({fixed * Transform{to_axis, Vec3::Zero()}, drive->joint, drive->rate,
                            drive->offset, joint.type == JointType::prismatic});
    fixed = Transform{to_axis.transpose(), Vec3::Zero()};
    moving.insert(drive->joint);
  }
  chain.tip_ = fixed;
  constexpr std::size_t kLeastJoints = 6;
  if (moving.size() < kLeastJoints || robot.joint_count() > kMostCellJoints ||
      chain.steps_.size() > kMostSteps) {
    return fail(ErrorCode::unsupported,
                "{} of {} joints of robot {} move link \"{}\"; a cell needs at least {} that do, "
                "and a group of at most {} joints",
                moving.size(), robot.joint_count(), robot.name(), link, kLeastJoints,
                kMostCellJoints);
  }
  chain.lower_.resize(robot.joint_count());
  chain.upper_.resize(robot.joint_count());
  constexpr double kUnlimited = std::numeric_limits<double>::infinity();
  for (int j = 0; j < robot.joint_count(); ++j) {
    const Joint& joint = robot.group_joint(j);
    chain.wraps_.push_back(joint.type == JointType::continuous);
    chain.lower_[j] = chain.wraps_.back() ? -kUnlimited : joint.lower;
    chain.upper_[j] = chain.wraps_.back() ? kUnlimited : joint.upper;
  }
  return chain;
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
  Jacobian weighted = jacobian;
  for (int j = 0; j < joint_count(); ++j) {
    const double room = std::min(q[j] - lower_[j], upper_[j] - q[j]);
    weighted.col(j) *= std::clamp(room / kLimitRoom, kLeastWeight, 1.0);
  }
  const Square gram = jacobian * weighted.transpose();
  return weighted.transpose() * gram.inverse();
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

}  // namespace mneme::internal
