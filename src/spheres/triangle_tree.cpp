// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "spheres/triangle_tree.h"

#include "base/as_index.h"
#include "geometry/enclosure.h"
#include "geometry/part_distance.h"

namespace mneme::internal {
namespace {

constexpr int kTrianglesPerLeaf = 4;

}  // namespace

TriangleTree::TriangleTree(TriangleMesh mesh)
    : mesh_(std::move(mesh)), tree_(boxes_of(mesh_), kTrianglesPerLeaf, Halving::median) {}

double TriangleTree::distance(const Vec3& point, double limit) const {
  const auto distance_to = [&](int i) {
    return (point - nearest_on(point, mesh_[as_index(i)])).norm();
  };
  const NearestPart nearest = tree_.nearest({point, point}, distance_to, limit);
  return nearest.part < 0 ? std::numeric_limits<double>::infinity() : nearest.distance;
}

bool TriangleTree::is_enclosed(const Vec3& point) const {
  return internal::is_enclosed(point,
                               [&](const Line& line) { return crossings_of(line, mesh_, tree_); });
}

}  // namespace mneme::internal
