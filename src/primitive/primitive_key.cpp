// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/primitive.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace mneme {
namespace {

constexpr std::size_t kPairKeySize = 6;

double squared(double value) { return value * value; }

/// Adds one circle's share to the squared distances of a plain [0] and a mirrored [1] image. The
/// terms come in the order of the key, as in any other sum over it, so that equal questions get
/// equal answers to the last bit.
void add_circle(const double* a, const double* b, double sums[2]) {
  const double x = squared(a[0] - b[0]);
  const double radius = squared(a[2] - b[2]);
  sums[0] = sums[0] + x + squared(a[1] - b[1]) + radius;
  sums[1] = sums[1] + x + squared(a[1] + b[1]) + radius;
}

}  // namespace

LocalPrimitive make_primitive(const PrimitiveKey& circles) {
  assert(circles.size() == kPairKeySize);
  LocalPrimitive primitive;
  primitive.obstacles = {0, 1};
  const double x = circles[0] + circles[3];
  const double y = circles[1] + circles[4];
  primitive.to_scene.rotation = std::atan2(y, x);
  primitive.key = moved(Symmetry{-primitive.to_scene.rotation, false}, circles);
  primitive.gap =
      std::hypot(circles[3] - circles[0], circles[4] - circles[1]) - circles[2] - circles[5];
  return primitive;
}

Scene make_scene(const PrimitiveKey& key) {
  assert(key.size() == kPairKeySize);
  const Sphere a{Vec3(key[0], key[1], 0), key[2]};
  const Sphere b{Vec3(key[3], key[4], 0), key[5]};
  return Scene{"primitive", {Obstacle{"circle_a", {a}}, Obstacle{"circle_b", {b}}}};
}

std::vector<KeyImage> images(const PrimitiveKey& canonical) {
  assert(canonical.size() == kPairKeySize);
  const PrimitiveKey& k = canonical;
  std::vector<KeyImage> result;
  result.reserve(4);
  result.push_back({k, false});
  result.push_back({{k[3], k[4], k[5], k[0], k[1], k[2]}, false});
  result.push_back({{k[0], -k[1], k[2], k[3], -k[4], k[5]}, true});
  result.push_back({{k[3], -k[4], k[5], k[0], -k[1], k[2]}, true});
  return result;
}

double similarity_error(const PrimitiveKey& a, const PrimitiveKey& b) {
  assert(a.size() == kPairKeySize && b.size() == kPairKeySize);
  double same_order[2] = {0, 0};
  add_circle(a.data(), b.data(), same_order);
  add_circle(a.data() + 3, b.data() + 3, same_order);
  double swapped[2] = {0, 0};
  add_circle(a.data() + 3, b.data(), swapped);
  add_circle(a.data(), b.data() + 3, swapped);
  return std::min(std::min(same_order[0], same_order[1]), std::min(swapped[0], swapped[1]));
}

}  // namespace mneme
