// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Nearest points on a surface, and which side of it a point is on.
#pragma once

#include "spheres/triangle_mesh.h"
#include "geometry/box_tree.h"

#include <limits>

namespace mneme::internal {

/// A surface with the tree of boxes that finds its triangles. Const and parallel-safe.
class TriangleTree {
 public:
  explicit TriangleTree(TriangleMesh mesh);

  /// Distance from `point` to the nearest triangle; infinite if that is not less than `limit`.
  [[nodiscard]] double distance(const Vec3& point,
                                double limit = std::numeric_limits<double>::infinity()) const;
  /// By the vote of lines (geometry/enclosure.h).
  [[nodiscard]] bool is_enclosed(const Vec3& point) const;

 private:
  TriangleMesh mesh_;
  BoxTree tree_;
};

}  // namespace mneme::internal
