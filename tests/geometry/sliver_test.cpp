// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/slivers.h"
#include "support/support.h"

#include <cmath>

namespace mneme::test {
namespace {

using internal::distance_between;

/// Metres; half the width of the widest sliver that counts as its edges is less.
constexpr double kSliverTolerance = 1e-7;

/// Its middle is at `middle`.
Triangle random_triangle_about(const Vec3& middle, double size, Rng& rng) {
  const Vec3 u = random_vector(rng, size), v = random_vector(rng, size);
  return {middle + u, middle + v, middle - u - v};
}

TEST_SUITE("law") {
  TEST_CASE("points and segments are as far from slivers as from their sections") {
    constexpr std::uint64_t kSeed = 81;
    Rng rng(kSeed);
    for (int i = 0; i < rounds(5000); ++i) {
      const Triangle sliver = random_sliver(rng);
      const double away = std::pow(10, rng.uniform(-17, 0));
      Vec3 a = random_point_of(sliver, rng), b = random_point_of(sliver, rng);
      a += random_vector(rng, away);
      b += random_vector(rng, away);
      INFO("seed " << kSeed << ", sliver " << i);
      const double of_point = distance_by_sections(a, a, sliver);
      const Vec3 nearest = internal::nearest_on(a, sliver);
      CHECK(std::abs((nearest - a).norm() - of_point) < kSliverTolerance);
      CHECK(distance_by_sections(nearest, nearest, sliver) < kSliverTolerance);
      const double of_segment = distance_by_sections(a, b, sliver);
      CHECK(std::abs(distance_between(a, b, sliver) - of_segment) < kSliverTolerance);
    }
  }

  TEST_CASE("slivers are as far from triangles as their sections, or farther than the limit") {
    constexpr std::uint64_t kSeed = 82;
    Rng rng(kSeed);
    int touching = 0;
    for (int i = 0; i < rounds(5000); ++i) {
      const Triangle sliver = random_sliver(rng);
      const double size = std::pow(10, rng.uniform(-2, -0.5));
      const Vec3 away = i % 2 == 0 ? Vec3::Zero() : random_vector(rng, 2 * size);
      const Triangle t = random_triangle_about(random_point_of(sliver, rng) + away, size, rng);
      const double expected = distance_by_sections(sliver, t);
      touching += expected == 0 ? 1 : 0;
      INFO("seed " << kSeed << ", sliver " << i);
      for (const double limit : {1e9, expected + 0.01}) {
        CHECK(std::abs(distance_between(sliver, t, limit) - expected) < kSliverTolerance);
        CHECK(std::abs(distance_between(t, sliver, limit) - expected) < kSliverTolerance);
      }
    }
    CHECK(touching > 1000);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("a triangle that the edge of a sliver pierces is not far from it") {
    const Triangle sliver{{-0.1, 1, 0.2}, {-0.06, 1.04, 0.6}, {0.02, 1.12, 1.4}};
    const Triangle pierced{
        {-0.00362, 1.12343, 1.34082}, {0.01495, 1.09439, 1.34187}, {0.03067, 1.12419, 1.33731}};
    for (const double limit : {1e-3, 1.0, 1e9}) {
      CHECK(distance_between(sliver, pierced, limit) == 0);
      CHECK(distance_between(pierced, sliver, limit) == 0);
    }
  }
}

}  // namespace
}  // namespace mneme::test
