// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Random geometry for laws and oracles.
#pragma once

#include "mneme/base.h"
#include "mneme/geometry.h"

#include <array>
#include <cmath>

namespace mneme::test {

inline Vec3 random_vector(Rng& rng, double size) {
  const double x = rng.uniform(-size, size);
  const double y = rng.uniform(-size, size);
  return {x, y, rng.uniform(-size, size)};
}

inline Transform random_pose(Rng& rng, double size) {
  std::array<double, 4> q{};
  do {
    for (double& value : q) value = rng.uniform(-1.0, 1.0);
  } while (std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3])) < 0.1);
  return {rotation_from_quaternion(q[0], q[1], q[2], q[3]), random_vector(rng, size)};
}

inline constexpr int kShapeKinds = 4;

/// A shape of the given kind (its index in Shape) within a few metres of the origin.
inline Shape random_shape(int kind, Rng& rng) {
  const double radius = rng.uniform(0.05, 1.0);
  const Transform pose = random_pose(rng, 2.0);
  switch (kind) {
    case 0:
      return Sphere{pose.translation, radius};
    case 1:
      return Box{pose, random_vector(rng, 1.0).cwiseAbs() + Vec3::Constant(0.02)};
    case 2:
      return Cylinder{pose, radius, rng.uniform(0.05, 2.0)};
    default:
      return Capsule{pose.translation, random_vector(rng, 2.0), radius};
  }
}

/// A segment that is now and then a point, parallel to an axis of the world, or to `direction`.
inline std::array<Vec3, 2> random_segment(Rng& rng, const Vec3& direction) {
  const Vec3 a = random_vector(rng, 3.0);
  const std::uint32_t kind = rng.index(8);
  if (kind == 0) return {a, a};
  if (kind == 1) return {a, a + rng.uniform(-2.0, 2.0) * Vec3::Unit(rng.index(3))};
  if (kind == 2) return {a, a + rng.uniform(-2.0, 2.0) * direction};
  if (kind == 3) return {a, a + rng.uniform(-2.0, 2.0) * direction + random_vector(rng, 1e-9)};
  return {a, random_vector(rng, 3.0)};
}

/// The direction that is special to a shape: its axis.
inline Vec3 axis_of(const Shape& shape) {
  if (const auto* box = std::get_if<Box>(&shape)) return box->pose.rotation.col(2);
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) return cylinder->pose.rotation.col(2);
  if (const auto* capsule = std::get_if<Capsule>(&shape)) return capsule->b - capsule->a;
  return Vec3::UnitZ();
}

}  // namespace mneme::test
