// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "covering/triangle_tree.h"

#include "base/as_index.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace mneme::internal {
namespace {

constexpr int kLeafSize = 4;

double distance2_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (p - a - t * along).squaredNorm();
}

double distance2_to_triangle(const Vec3& p, const Triangle& t) {
  const Vec3 normal = (t.b - t.a).cross(t.c - t.a);
  const double area2 = normal.squaredNorm();
  const auto is_left = [&](const Vec3& a, const Vec3& b) {
    return normal.dot((b - a).cross(p - a)) >= 0;
  };
  if (area2 > 0 && is_left(t.a, t.b) && is_left(t.b, t.c) && is_left(t.c, t.a)) {
    const double height = normal.dot(p - t.a);
    return height * height / area2;
  }
  return std::min({distance2_to_segment(p, t.a, t.b), distance2_to_segment(p, t.b, t.c),
                   distance2_to_segment(p, t.c, t.a)});
}

double distance2_to_box(const Vec3& p, const Vec3& low, const Vec3& high) {
  return (p - p.cwiseMax(low).cwiseMin(high)).squaredNorm();
}

bool meets_box(const Vec3& origin, const Vec3& inverse, const Vec3& low, const Vec3& high) {
  const Vec3 t0 = (low - origin).cwiseProduct(inverse);
  const Vec3 t1 = (high - origin).cwiseProduct(inverse);
  return t0.cwiseMin(t1).maxCoeff() <= t0.cwiseMax(t1).minCoeff();
}

/// Where along the line the triangle is crossed: 1 ahead, -1 behind, 0 not at all. By Moller and
/// Trumbore, DOI 10.1080/10867651.1997.10487468.
int crossing(const Vec3& origin, const Vec3& direction, const Triangle& t) {
  const Vec3 ab = t.b - t.a;
  const Vec3 ac = t.c - t.a;
  const Vec3 p = direction.cross(ac);
  const double determinant = ab.dot(p);
  if (determinant == 0) return 0;
  const Vec3 offset = origin - t.a;
  const double u = offset.dot(p) / determinant;
  if (u < 0 || u > 1) return 0;
  const Vec3 q = offset.cross(ab);
  const double v = direction.dot(q) / determinant;
  if (v < 0 || u + v > 1) return 0;
  return ac.dot(q) / determinant > 0 ? 1 : -1;
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
    least2 = std::min(least2, distance2_to_triangle(point, triangle));
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

bool TriangleTree::is_odd_both_ways(const Vec3& origin, const Vec3& direction) const {
  const Vec3 inverse = direction.cwiseInverse();
  int ahead = 0;
  int behind = 0;
  std::vector<int> open = {0};
  while (!open.empty()) {
    const int index = open.back();
    open.pop_back();
    const Node& node = nodes_[as_index(index)];
    if (!meets_box(origin, inverse, node.low, node.high)) continue;
    for (int i = 0; i < node.count; ++i) {
      const int side = crossing(origin, direction, mesh_[as_index(node.first + i)]);
      ahead += side > 0 ? 1 : 0;
      behind += side < 0 ? 1 : 0;
    }
    if (node.count == 0) open.insert(open.end(), {index + 1, node.right});
  }
  return ahead % 2 == 1 && behind % 2 == 1;
}

bool TriangleTree::is_enclosed(const Vec3& point) const {
  if (nodes_.empty()) return false;
  // In no plane that models tend to have faces in, so that a line rarely runs along an edge.
  static const std::array<Vec3, 5> kDirections = {
      Vec3(0.8165, 0.4373, 0.3767), Vec3(-0.3419, 0.8721, 0.3503), Vec3(0.2911, -0.3673, 0.8834),
      Vec3(-0.6173, -0.5231, 0.5877), Vec3(0.4813, -0.6329, -0.6067)};
  int yes = 0;
  int no = 0;
  for (const Vec3& direction : kDirections) {
    ++(is_odd_both_ways(point, direction) ? yes : no);
    if (std::max(yes, no) == 3) break;
  }
  return yes == 3;
}

}  // namespace mneme::internal
