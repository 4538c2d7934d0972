// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What only some ask of shapes: sizes, moments, projections onto them.
#pragma once

#include "mneme/geometry.h"

#include <span>
#include <vector>

namespace mneme::internal {

/// True of points, meshes and octrees, which have no one place and size.
[[nodiscard]] bool is_compound(const Shape& shape);

/// The point of a solid that is nearest to `p`: `p` itself inside.
[[nodiscard]] Vec3 nearest_point(const Vec3& p, const Shape& shape);

/// Metres: full extents of a box; radius and length of a cylinder or capsule; radius of a sphere;
/// nothing of a compound shape.
[[nodiscard]] std::vector<double> sizes_of(const Shape& shape);
/// `shape` in its place with these sizes, as many as it has.
[[nodiscard]] Shape resized(const Shape& shape, std::span<const double> sizes);
/// All lengths times `factor`, about a point.
[[nodiscard]] Shape scaled(const Shape& shape, const Vec3& about, double factor);

/// A box around a compound shape, turned so that its surface is small: about the principal axes of
/// some of its parts.
template <class Part>
[[nodiscard]] Box oriented_box(const CompoundShape<Part>& compound);

/// Volume, centroid and covariance of a solid.
struct Moments {
  double volume = 0;
  Vec3 centroid = Vec3::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};
/// A capsule counts as the cylinder of the same radius and volume, a compound shape as its oriented
/// box.
[[nodiscard]] Moments moments_of(const Shape& shape);

}  // namespace mneme::internal
