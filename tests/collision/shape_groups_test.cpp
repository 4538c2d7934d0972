// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "collision/shape_groups.h"
#include "geometry/random_shapes.h"
#include "support/support.h"

#include <algorithm>
#include <vector>

namespace mneme::test {
namespace {

std::vector<Capsule> random_capsules(std::size_t count, Rng& rng) {
  std::vector<Capsule> shapes;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 a = random_vector(rng, 1.0);
    const bool is_sphere = rng.index(2) == 0;
    const Vec3 b = is_sphere ? a : Vec3(a + random_vector(rng, 0.5));
    shapes.push_back({a, b, rng.uniform(0.01, 0.3)});
  }
  return shapes;
}

double reach_of(const Capsule& shape, const Vec3& from) {
  return std::max((shape.a - from).norm(), (shape.b - from).norm()) + shape.radius;
}

TEST_SUITE("unit") {
  TEST_CASE("the ball around a single shape is its own") {
    const std::vector<Capsule> sphere = {{{1, 2, 3}, {1, 2, 3}, 0.5}};
    CHECK(internal::enclosing_ball(sphere).center.isApprox(Vec3(1, 2, 3)));
    CHECK(internal::enclosing_ball(sphere).radius == doctest::Approx(0.5));
    const std::vector<Capsule> capsule = {{{0, 0, 0}, {2, 0, 0}, 0.5}};
    CHECK(internal::enclosing_ball(capsule).center.isApprox(Vec3(1, 0, 0)));
    CHECK(internal::enclosing_ball(capsule).radius == doctest::Approx(1.5));
  }

  TEST_CASE("the ball around two balls touches both, or is the one that contains the other") {
    const Sphere small{{0, 0, 0}, 0.5}, far{{4, 0, 0}, 1}, large{{0.25, 0, 0}, 2};
    CHECK(internal::enclosing_ball(small, far).center.isApprox(Vec3(2.25, 0, 0)));
    CHECK(internal::enclosing_ball(small, far).radius == doctest::Approx(2.75));
    CHECK(internal::enclosing_ball(small, large).radius == 2);
    CHECK(internal::enclosing_ball(large, small).radius == 2);
  }

  TEST_CASE("no shapes make no groups") { CHECK(internal::sort_into_groups({}, 4).empty()); }

  TEST_CASE("neighbours share a group") {
    std::vector<Capsule> shapes;
    for (const double x : {5.0, 0.2, 5.1, 0.0, 0.1, 5.2})
      shapes.push_back({{x, 0, 0}, {x, 0, 0}, 0.1});
    CHECK(internal::sort_into_groups(shapes, 3) == std::vector<std::size_t>{3, 6});
    for (std::size_t i = 0; i < 6; ++i) CHECK((shapes[i].a.x() < 1) == (i < 3));
  }
}

TEST_SUITE("law") {
  TEST_CASE("the ball contains all shapes and is not much larger than any ball that does") {
    Rng rng(521);
    for (int i = 0; i < 300; ++i) {
      const auto shapes = random_capsules(1 + rng.index(12), rng);
      const Sphere ball = internal::enclosing_ball(shapes);
      double farthest = 0, widest = 0;
      for (const Capsule& a : shapes) {
        farthest = std::max(farthest, reach_of(a, ball.center));
        for (const Capsule& b : shapes) {
          widest = std::max({widest, reach_of(b, a.a) + a.radius, reach_of(b, a.b) + a.radius});
        }
      }
      INFO("seed 521, set " << i);
      REQUIRE(ball.radius >= farthest - 1e-12);
      // By Jung's theorem for points; the ball found may exceed the smallest one a little.
      REQUIRE(ball.radius <= widest * 0.6124 * 1.1);
    }
  }

  TEST_CASE("groups keep all shapes, in groups that are full but for the rest") {
    Rng rng(522);
    for (std::size_t count = 1; count < 60; ++count) {
      for (const std::size_t most : {1, 4, 8}) {
        auto shapes = random_capsules(count, rng);
        auto before = shapes;
        const auto ends = internal::sort_into_groups(shapes, most);
        REQUIRE(ends.size() == (count + most - 1) / most);
        REQUIRE(ends.back() == count);
        for (std::size_t i = 0, begin = 0; i < ends.size(); begin = ends[i++]) {
          REQUIRE(ends[i] > begin);
          REQUIRE(ends[i] - begin <= most);
        }
        const auto by_place = [](const Capsule& a, const Capsule& b) { return a.a.x() < b.a.x(); };
        std::sort(shapes.begin(), shapes.end(), by_place);
        std::sort(before.begin(), before.end(), by_place);
        for (std::size_t i = 0; i < count; ++i) REQUIRE(shapes[i].a == before[i].a);
      }
    }
  }
}

}  // namespace
}  // namespace mneme::test
