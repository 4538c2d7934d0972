// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Sizes, moments, projections and flaws of shapes, and distances from the solids inside meshes.
#pragma once

#include "mneme/geometry.h"

#include <span>
#include <string>
#include <string_view>
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

/// The flaw of a shape, such as "has no parts", or nothing: a size that is not positive, a
/// pose that is no rotation, numbers that are not finite, a compound shape without parts.
[[nodiscard]] std::string_view find_flaw(const Shape& shape);

/// "its box has no parts", of a box and "has no parts".
[[nodiscard]] std::string said_of(const Shape& shape, std::string_view flaw);

/// Metres between a shape and a surface, without its radius, with all that it encloses: 0 if they
/// meet, and where lines do not show that each part of the shape is outside. A shape that is itself
/// a mesh counts as its surface. Exact, from a cylinder to within 1e-9 m.
[[nodiscard]] double distance_to_solid(const Mesh& surface, const Shape& shape);

/// Metres between two surfaces, without their radii, with all that each encloses: as
/// distance_to_solid, exact if that is less than `enough`, which is above 0, and otherwise anything
/// from `enough` on.
[[nodiscard]] double distance_between_solids(const Mesh& a, const Mesh& b, double enough);

}  // namespace mneme::internal
