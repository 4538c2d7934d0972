// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/part_distance.h"
#include "base/as_index.h"

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>
#include <vector>

namespace mneme::internal {

bool Line::meets(const AxisBox& box) const {
  const Vec3 t0 = (box.low - origin_).cwiseProduct(inverse_);
  const Vec3 t1 = (box.high - origin_).cwiseProduct(inverse_);
  return t0.cwiseMin(t1).maxCoeff() <= t0.cwiseMax(t1).minCoeff();
}

// By Moller and Trumbore, DOI 10.1080/10867651.1997.10487468.
void Line::cross(const Triangle& t, Crossings& crossings) const {
  const Vec3 ab = t.b - t.a;
  const Vec3 ac = t.c - t.a;
  const Vec3 p = direction_.cross(ac);
  const double determinant = ab.dot(p);
  if (determinant == 0) return;
  const Vec3 offset = origin_ - t.a;
  const double u = offset.dot(p) / determinant;
  if (u < 0 || u > 1) return;
  const Vec3 q = offset.cross(ab);
  const double v = direction_.dot(q) / determinant;
  if (v < 0 || u + v > 1) return;
  const bool is_ahead = ac.dot(q) / determinant > 0;
  ++(is_ahead ? crossings.ahead : crossings.behind);
  // The determinant is positive if the line runs against the triangle's normal.
  (is_ahead ? crossings.exits_ahead : crossings.exits_behind) +=
      (determinant > 0) == is_ahead ? -1 : 1;
}

Crossings crossings_of(const Line& line, const Parts<Triangle>& surface) {
  const auto shared = PartsAccess::tree(surface);
  const BoxTree& tree = *shared;
  Crossings crossings;
  std::vector<int> open = {0};
  while (!open.empty()) {
    const int index = open.back();
    open.pop_back();
    const BoxTree::Node& node = tree.nodes()[as_index(index)];
    if (!line.meets(node.box)) continue;
    for (int i = node.first; i < node.first + node.count; ++i) {
      line.cross(surface.list()[as_index(tree.order()[as_index(i)])], crossings);
    }
    if (node.right >= 0) open.insert(open.end(), {index + 1, node.right});
  }
  return crossings;
}

const std::array<Vec3, 5>& line_directions() {
  static const std::array<Vec3, 5> directions = {
      Vec3(0.8165, 0.4373, 0.3767), Vec3(-0.3419, 0.8721, 0.3503), Vec3(0.2911, -0.3673, 0.8834),
      Vec3(-0.6173, -0.5231, 0.5877), Vec3(0.4813, -0.6329, -0.6067)};
  return directions;
}

Vec3 spiral_point(int index, int count) {
  const double golden_angle = std::numbers::pi * (3 - std::sqrt(5.0));
  const double z = 1 - (2 * index + 1.0) / count;
  const double radius = std::sqrt(1 - z * z);
  return {radius * std::cos(golden_angle * index), radius * std::sin(golden_angle * index), z};
}

}  // namespace mneme::internal
