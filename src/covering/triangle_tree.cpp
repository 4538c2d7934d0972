// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "covering/triangle_tree.h"

#include "base/as_index.h"
#include "geometry/part_distance.h"

#include <algorithm>
#include <cmath>

namespace mneme::internal {
namespace {

constexpr int kLeafSize = 4;

double distance2_to_box(const Vec3& p, const Vec3& low, const Vec3& high) {
  return (p - p.cwiseMax(low).cwiseMin(high)).squaredNorm();
}

}  // namespace

TriangleTree::TriangleTree(TriangleMesh mesh) : mesh_(std::move(mesh)) {
  nodes_.reserve(mesh_.size());
  if (!mesh_.empty()) build(0, static_cast<int>(mesh_.size()));
}

int TriangleTree::build(int first, int count) {
  const auto begin = mesh_.begin() + first;
  const auto end = begin + count;
  const Bounds bounds = bounds_of({begin, end});
  const int index = static_cast<int>(nodes_.size());
  nodes_.push_back({bounds.low, bounds.high, first, count, -1});
  if (count <= kLeafSize) return index;
  Eigen::Index axis = 0;
  (bounds.high - bounds.low).maxCoeff(&axis);
  const int half = count / 2;
  std::nth_element(begin, begin + half, end, [axis](const Triangle& s, const Triangle& t) {
    return s.centroid()[axis] < t.centroid()[axis];
  });
  build(first, half);
  const int right = build(first + half, count - half);
  nodes_[as_index(index)].count = 0;
  nodes_[as_index(index)].right = right;
  return index;
}

double TriangleTree::distance(const Vec3& point, double limit) const {
  double least2 = limit * limit;
  if (!nodes_.empty()) nearest(0, point, least2);
  const double least = std::sqrt(least2);
  return least < limit ? least : std::numeric_limits<double>::infinity();
}

void TriangleTree::nearest(int index, const Vec3& point, double& least2) const {
  const Node& node = nodes_[as_index(index)];
  for (int i = 0; i < node.count; ++i) {
    const Triangle& triangle = mesh_[as_index(node.first + i)];
    least2 = std::min(least2, (point - nearest_on(point, triangle)).squaredNorm());
  }
  if (node.count > 0) return;
  const auto reach = [&](int child) {
    const Node& box = nodes_[as_index(child)];
    return distance2_to_box(point, box.low, box.high);
  };
  int near = index + 1;
  int far = node.right;
  double near2 = reach(near);
  double far2 = reach(far);
  if (far2 < near2) {
    std::swap(near, far);
    std::swap(near2, far2);
  }
  if (near2 < least2) nearest(near, point, least2);
  if (far2 < least2) nearest(far, point, least2);
}

Crossings TriangleTree::crossings_of(const Line& line) const {
  Crossings crossings;
  std::vector<int> open = {0};
  while (!open.empty()) {
    const int index = open.back();
    open.pop_back();
    const Node& node = nodes_[as_index(index)];
    if (!line.meets({node.low, node.high})) continue;
    for (int i = 0; i < node.count; ++i) line.cross(mesh_[as_index(node.first + i)], crossings);
    if (node.count == 0) open.insert(open.end(), {index + 1, node.right});
  }
  return crossings;
}

bool TriangleTree::is_enclosed(const Vec3& point) const {
  return !nodes_.empty() &&
         internal::is_enclosed(point, [&](const Line& line) { return crossings_of(line); });
}

}  // namespace mneme::internal
