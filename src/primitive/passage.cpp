// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "primitive/passage.h"

#include "geometry/solids.h"

namespace mneme::internal {
namespace {

constexpr double kTouching = 1e-5;  // as exact as distances of solids are

}  // namespace

ClosestShapes closest_shapes(const Obstacle& a, const Obstacle& b, double most) {
  ClosestShapes closest;
  for (const Shape& first : a.shapes) {
    const Sphere around_first = bounding_sphere(first);
    for (const Shape& second : b.shapes) {
      const Sphere around = bounding_sphere(second);
      const double bound =
          (around.center - around_first.center).norm() - around.radius - around_first.radius;
      if (bound > most) continue;
      const double now = distance(first, second);
      if (now < closest.distance) closest = {&first, &second, now};
    }
  }
  return closest;
}

// Averaged projections (Bauschke and Borwein, DOI 10.1137/S0036144593251710) end at the middle of a
// shortest segment between convex sets; where the sets are parallel they hardly move sideways.
std::optional<Passage> find_passage(const Obstacle& a, const Obstacle& b, double most) {
  constexpr int kMostRounds = 200;
  constexpr double kSettled = 1e-7;
  const ClosestShapes closest = closest_shapes(a, b, most);
  if (closest.distance > most || closest.distance < kTouching) return std::nullopt;
  Vec3 middle = 0.5 * (bounding_sphere(*closest.a).center + bounding_sphere(*closest.b).center);
  Passage passage;
  for (int round = 0; round < kMostRounds; ++round) {
    passage = {nearest_point(middle, *closest.a), nearest_point(middle, *closest.b)};
    const Vec3 next = passage.middle();
    const bool has_settled = (next - middle).norm() < kSettled;
    middle = next;
    if (has_settled) break;
  }
  return passage;
}

}  // namespace mneme::internal
