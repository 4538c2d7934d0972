// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Nearest points on a surface, and which side of it a point is on.
#pragma once

#include "covering/triangle_mesh.h"
#include "geometry/enclosure.h"

#include <limits>
#include <vector>

namespace mneme::internal {

/// A tree of boxes over triangles. Const and parallel-safe. Of the libraries in Debian nanoflann
/// knows points only, FCL (which the tests use) neither limits nor counts of crossings, and CGAL is
/// under the GPL.
class TriangleTree {
 public:
  explicit TriangleTree(TriangleMesh mesh);

  /// Distance from `point` to the nearest triangle; infinite if that is not less than `limit`.
  [[nodiscard]] double distance(const Vec3& point,
                                double limit = std::numeric_limits<double>::infinity()) const;
  /// By the vote of lines (geometry/enclosure.h).
  [[nodiscard]] bool is_enclosed(const Vec3& point) const;

 private:
  struct Node {
    Vec3 low;
    Vec3 high;
    int first = 0;   ///< of its triangles
    int count = 0;   ///< 0 if it has children
    int right = -1;  ///< the left child follows its parent
  };
  int build(int first, int count);
  void nearest(int node, const Vec3& point, double& least2) const;
  [[nodiscard]] Crossings crossings_of(const Line& line) const;

  TriangleMesh mesh_;
  std::vector<Node> nodes_;
};

}  // namespace mneme::internal
