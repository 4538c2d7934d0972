// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Triangles that are nearly segments, and distances from triangles that need no normal.
#pragma once

#include "geometry/part_distance.h"
#include "geometry/random_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mneme::test {

/// From a centimetre to a metre long; as narrow as rounding makes what lies on a line, or up to a
/// centimetre wide.
inline Triangle random_sliver(Rng& rng) {
  std::array<Vec3, 3> corners;
  if (rng.index(2) == 0) {  // on a line, in centimetres
    const auto integers = [&](double most) -> Vec3 {
      return random_vector(rng, most).array().round();
    };
    const Vec3 at = integers(60), step = integers(8);
    for (Vec3& corner : corners) corner = (at + std::round(rng.uniform(-8, 8)) * step) / 100;
  } else {
    const Vec3 at = random_vector(rng, 0.6);
    const Vec3 along = random_vector(rng, std::pow(10, rng.uniform(-2, 0)));
    const Vec3 aside = random_vector(rng, std::pow(10, rng.uniform(-17, -2)));
    corners = {at, at + along, at + rng.uniform(0, 1) * along + aside};
  }
  const std::size_t first = rng.index(3);
  return {corners[first], corners[(first + 1) % 3], corners[(first + 2) % 3]};
}

/// The section of a triangle at `share` of the way from one corner to the opposite edge.
inline std::array<Vec3, 2> section_of(const Triangle& t, double share) {
  return {t.a + share * (t.b - t.a), t.a + share * (t.c - t.a)};
}

inline Vec3 random_point_of(const Triangle& t, Rng& rng) {
  const auto [p, q] = section_of(t, rng.uniform(0, 1));
  return p + rng.uniform(0, 1) * (q - p);
}

/// The least distance of a section. They are a convex function of the share.
template <class DistanceOfSection>
double least_of_sections(const Triangle& t, const DistanceOfSection& distance_of) {
  const auto at = [&](double share) {
    const auto [p, q] = section_of(t, share);
    return distance_of(p, q);
  };
  double low = 0, high = 1;
  for (int i = 0; i < 80; ++i) {
    const double left = low + (high - low) / 3, right = high - (high - low) / 3;
    (at(left) < at(right) ? high : low) = at(left) < at(right) ? right : left;
  }
  return std::min({at(0), at(1), at(low)});
}

inline double distance_by_sections(const Vec3& a, const Vec3& b, const Triangle& t) {
  return least_of_sections(
      t, [&](const Vec3& p, const Vec3& q) { return segment_distance(a, b, p, q); });
}

/// The second one is no sliver.
inline double distance_by_sections(const Triangle& s, const Triangle& t) {
  return least_of_sections(
      s, [&](const Vec3& p, const Vec3& q) { return internal::distance_between(p, q, t); });
}

}  // namespace mneme::test
