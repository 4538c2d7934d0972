// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/geometry.h"

#include <Eigen/Geometry>

#include <cmath>

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

namespace {

struct Name {
  std::string_view operator()(const Sphere&) const { return "sphere"; }
  std::string_view operator()(const Box&) const { return "box"; }
  std::string_view operator()(const Cylinder&) const { return "cylinder"; }
  std::string_view operator()(const Capsule&) const { return "capsule"; }
};

struct Move {
  const Transform& X_AB;
  Shape operator()(const Sphere& s) const { return Sphere{X_AB * s.center, s.radius}; }
  Shape operator()(const Box& s) const { return Box{X_AB * s.pose, s.half_extents}; }
  Shape operator()(const Cylinder& s) const { return Cylinder{X_AB * s.pose, s.radius, s.length}; }
  Shape operator()(const Capsule& s) const { return Capsule{X_AB * s.a, X_AB * s.b, s.radius}; }
};

struct Bound {
  Sphere operator()(const Sphere& s) const { return s; }
  Sphere operator()(const Box& s) const { return {s.pose.translation, s.half_extents.norm()}; }
  Sphere operator()(const Cylinder& s) const {
    return {s.pose.translation, std::hypot(s.radius, 0.5 * s.length)};
  }
  Sphere operator()(const Capsule& s) const {
    return {0.5 * (s.a + s.b), 0.5 * (s.b - s.a).norm() + s.radius};
  }
};

}  // namespace

std::string_view shape_name(const Shape& shape) { return std::visit(Name{}, shape); }

Shape transformed(const Transform& X_AB, const Shape& shape) {
  return std::visit(Move{X_AB}, shape);
}

Sphere bounding_sphere(const Shape& shape) { return std::visit(Bound{}, shape); }

}  // namespace mneme
