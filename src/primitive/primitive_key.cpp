// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/primitive.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace mneme {
namespace {

constexpr std::size_t kPairKeySize = 6;
constexpr std::size_t kBodyPairKeySize = 2 * kBodyKeySize;

double squared(double value) { return value * value; }

/// Squared distance between the circles (p, q) and the key `b`, or the mirror image of it if that
/// is nearer. Neither image is ever written down: the mirror only turns differences of y into sums.
double nearer_image(const double* p, const double* q, const double* b) {
  const double common =
      (squared(p[0] - b[0]) + squared(p[2] - b[2])) + (squared(q[0] - b[3]) + squared(q[2] - b[5]));
  const double plain = squared(p[1] - b[1]) + squared(q[1] - b[4]);
  const double mirrored = squared(p[1] + b[1]) + squared(q[1] + b[4]);
  return common + std::min(plain, mirrored);
}

double squared_distance(const PrimitiveKey& a, const PrimitiveKey& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += squared(a[i] - b[i]);
  return sum;
}

bool is_of_query(const PrimitiveKey& key) { return key.size() % 2 == 1; }

/// The key of the query from the goal to the start, which is as long.
PrimitiveKey reversed_query(PrimitiveKey key) {
  const auto ends = key.begin() + 1;
  std::rotate(ends, ends + (key.end() - ends) / 2, key.end());
  return key;
}

}  // namespace

LocalPrimitive make_primitive(const PrimitiveKey& circles) {
  assert(circles.size() == kPairKeySize);
  LocalPrimitive primitive;
  primitive.obstacles = {0, 1};
  const double x = circles[0] + circles[3];
  const double y = circles[1] + circles[4];
  primitive.to_scene.rotation = std::atan2(y, x);
  primitive.key = moved_key(Symmetry{-primitive.to_scene.rotation, false}, circles);
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
  if (is_of_query(canonical)) return {{canonical, false}, {reversed_query(canonical), false}};
  if (canonical.size() == kBodyPairKeySize) {
    PrimitiveKey swapped = canonical;
    std::rotate(swapped.begin(), swapped.begin() + kBodyKeySize, swapped.end());
    return {{canonical, false}, {std::move(swapped), false}};
  }
  if (canonical.size() == kGapKeySize) return {{canonical, false}};
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
  if (is_of_query(a) && a.size() == b.size()) {
    return std::min(squared_distance(a, b), squared_distance(a, reversed_query(b)));
  }
  if (a.size() == kBodyPairKeySize && b.size() == kBodyPairKeySize) {
    double plain = 0, swapped = 0;
    for (std::size_t i = 0; i < kBodyPairKeySize; ++i) {
      plain += squared(a[i] - b[i]);
      swapped += squared(a[i] - b[(i + kBodyKeySize) % kBodyPairKeySize]);
    }
    return std::min(plain, swapped);
  }
  if (a.size() == kGapKeySize && b.size() == kGapKeySize) {
    return squared_distance(a, b);
  }
  assert(a.size() == kPairKeySize && b.size() == kPairKeySize);
  const double* first = a.data();
  const double* second = first + 3;
  return std::min(nearer_image(first, second, b.data()), nearer_image(second, first, b.data()));
}

}  // namespace mneme
