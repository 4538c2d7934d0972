// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/held_joints.h"

#include "base/fail.h"

#include <Eigen/Geometry>

#include <cmath>

namespace mneme::internal {
namespace {

/// Largest difference from 1 of a quaternion's length: files round to few digits.
constexpr double kUnitLength = 1e-3;

/// The frame whose x and y axes a planar joint moves along: the joint frame if its axis is z.
Eigen::Quaterniond plane_of(const Joint& joint) {
  return Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), joint.axis);
}

Transform planar_pose(const Joint& joint, std::map<std::string, double>& values) {
  const Eigen::Matrix3d plane = plane_of(joint).toRotationMatrix();
  const std::string& name = joint.name;
  return {rotation_about(joint.axis, values[name + "/theta"]),
          plane * Vec3(values[name + "/x"], values[name + "/y"], 0)};
}

Result<Transform> floating_pose(const Joint& joint, std::map<std::string, double>& values) {
  const auto value = [&](const char* suffix) { return values[joint.name + suffix]; };
  const Eigen::Quaterniond rotation(value("/rot_w"), value("/rot_x"), value("/rot_y"),
                                    value("/rot_z"));
  if (!(std::abs(rotation.norm() - 1) <= kUnitLength)) {
    return fail(ErrorCode::invalid,
                "the quaternion {0}/rot_x, {0}/rot_y, {0}/rot_z, {0}/rot_w has the length {1:.4g}, "
                "expected 1",
                joint.name, rotation.norm());
  }
  return Transform{rotation.normalized().toRotationMatrix(),
                   {value("/trans_x"), value("/trans_y"), value("/trans_z")}};
}

Result<Transform> pose_of(const Joint& joint, std::map<std::string, double>& values) {
  if (joint.held->is_planar) return planar_pose(joint, values);
  return floating_pose(joint, values);
}

}  // namespace

std::map<std::string, double> held_values(const Joint& joint, const Transform& pose) {
  const std::string& name = joint.name;
  const Vec3& p = pose.translation;
  if (joint.held->is_planar) {
    const Eigen::Matrix3d plane = plane_of(joint).toRotationMatrix();
    const Eigen::Matrix3d turn = plane.transpose() * pose.rotation * plane;
    const Vec3 in_plane = plane.transpose() * p;
    return {{name + "/x", in_plane.x()},
            {name + "/y", in_plane.y()},
            {name + "/theta", std::atan2(turn(1, 0), turn(0, 0))}};
  }
  const Eigen::Quaterniond q(pose.rotation);
  return {{name + "/trans_x", p.x()}, {name + "/trans_y", p.y()}, {name + "/trans_z", p.z()},
          {name + "/rot_x", q.x()},   {name + "/rot_y", q.y()},   {name + "/rot_z", q.z()},
          {name + "/rot_w", q.w()}};
}

Result<void> hold_joints(std::span<Joint> joints, std::map<std::string, double>& values) {
  for (Joint& joint : joints) {
    if (!joint.held) continue;
    std::map<std::string, double> own = held_values(joint, joint.held->pose);
    bool is_moved = false;
    for (auto& [name, value] : own) {
      const auto given = values.extract(name);
      if (given.empty()) continue;
      is_moved = true;
      value = given.mapped();
      if (std::isfinite(value)) continue;
      return fail(ErrorCode::invalid, "the fixed value of '{}' is {}, expected a number", name,
                  value);
    }
    if (!is_moved) continue;
    const Transform pose = MNEME_TRY(pose_of(joint, own));
    joint.origin = joint.origin * joint.held->pose.inverse() * pose;
    joint.held->pose = pose;
  }
  return {};
}

}  // namespace mneme::internal
