// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Fast distances between points and a surface.
#pragma once

#include "spheres/triangle_mesh.h"
#include "geometry/parts.h"

#include <limits>
#include <vector>

namespace mneme::internal {

/// Const is parallel-safe.
class SurfaceDistance {
 public:
  explicit SurfaceDistance(TriangleMesh mesh);

  [[nodiscard]] bool is_empty() const { return facets_.empty(); }
  /// Returns the distance to the nearest triangle, or `limit` if that is not less. Cost: below a
  /// microsecond for ten thousand triangles, less with a tight limit.
  [[nodiscard]] double from(const Vec3& point,
                            double limit = std::numeric_limits<double>::infinity()) const {
    return find(point, limit).distance;
  }
  /// Returns the nearest point of the surface. Precondition: it is not empty, and `limit` is above
  /// the distance.
  [[nodiscard]] Vec3 nearest(const Vec3& point,
                             double limit = std::numeric_limits<double>::infinity()) const;

 private:
  /// A triangle with precomputed products of its edges.
  struct Facet {
    explicit Facet(const Triangle& triangle);
    [[nodiscard]] double squared_distance(const Vec3& point) const;

    Triangle triangle;
    Vec3 ab, ac, normal;
    double ab_ab, ab_ac, ac_ac;
    double normal2;  ///< 0 for slivers
  };

  [[nodiscard]] NearestPart find(const Vec3& point, double limit) const;

  std::vector<Facet> facets_;
  BoxTree tree_;
};

}  // namespace mneme::internal
