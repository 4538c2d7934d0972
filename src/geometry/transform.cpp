// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/geometry.h"

#include <Eigen/Geometry>

namespace mneme {

Eigen::Matrix3d rotation_about(const Vec3& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

Eigen::Matrix3d rotation_from_rpy(const Vec3& rpy) {
  return rotation_about(Vec3::UnitZ(), rpy.z()) * rotation_about(Vec3::UnitY(), rpy.y()) *
         rotation_about(Vec3::UnitX(), rpy.x());
}

Eigen::Matrix3d rotation_from_quaternion(double w, double x, double y, double z) {
  Eigen::Quaterniond quaternion(w, x, y, z);
  quaternion.coeffs().stableNormalize();
  return quaternion.toRotationMatrix();
}

}  // namespace mneme
