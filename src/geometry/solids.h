// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Sizes, moments, nearest points and flaws of shapes, and distances to the solids inside meshes.
#pragma once

#include "mneme/geometry.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// True if the columns are orthonormal to within 1e-6, and right-handed.
[[nodiscard]] bool is_rotation(const Eigen::Matrix3d& matrix);

/// True for points, meshes and octrees.
[[nodiscard]] bool is_compound(const Shape& shape);
/// Number of points, triangles or cubes of a compound shape; 0 for others.
[[nodiscard]] std::size_t part_count(const Shape& shape);

/// The point of a shape nearest to `p`; `p` itself inside.
[[nodiscard]] Vec3 nearest_point(const Vec3& p, const Shape& shape);
[[nodiscard]] Vec3 nearest_point(const Vec3& p, const Box& box);
[[nodiscard]] Vec3 nearest_point(const Vec3& p, const Cylinder& cylinder);

/// Sizes in metres: full extents of a box; radius and length of a cylinder or capsule; radius of a
/// sphere. Empty for compound shapes.
[[nodiscard]] std::vector<double> sizes_of(const Shape& shape);
/// `shape` at the same pose with other sizes, as sizes_of() returns them.
[[nodiscard]] Shape resized(const Shape& shape, std::span<const double> sizes);
/// `shape` scaled by `factor` about a point.
[[nodiscard]] Shape scaled(const Shape& shape, const Vec3& about, double factor);

/// A box around a compound shape with a small surface, near the principal axes of the parts.
template <class Part>
[[nodiscard]] Box oriented_box(const CompoundShape<Part>& compound);

/// Volume, centroid and covariance of a solid.
struct Moments {
  double volume = 0;
  Vec3 centroid = Vec3::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};
/// Moments of a shape. A capsule counts as the cylinder of the same radius and volume, a compound
/// shape as its oriented box.
[[nodiscard]] Moments moments_of(const Shape& shape);

/// The flaw of a shape, such as "has no parts"; empty if there is none. Flaws are sizes that are
/// not positive, poses without a rotation, numbers that are not finite, and missing parts.
[[nodiscard]] std::string_view find_flaw(const Shape& shape);

/// The flaw as a sentence, such as "its mesh has no parts".
[[nodiscard]] std::string said_of(const Shape& shape, std::string_view flaw);

/// Metres between a shape and the solid that a mesh encloses, without the mesh's radius. 0 if they
/// meet, or if the test of enclosure cannot show that each part of the shape is outside. A shape
/// that is a mesh counts as its surface. Exact, for cylinders to within 1e-9 m.
[[nodiscard]] double distance_to_solid(const Mesh& surface, const Shape& shape);

/// True unless it is proven that no piece of `shape`, which does not touch the surface, is inside
/// it.
[[nodiscard]] bool may_enclose(const Mesh& surface, const Shape& shape);

/// Metres between the solids that two meshes enclose, without their radii. Exact if less than
/// `enough` > 0, otherwise any value of at least `enough`.
[[nodiscard]] double distance_between_solids(const Mesh& a, const Mesh& b, double enough);

}  // namespace mneme::internal
