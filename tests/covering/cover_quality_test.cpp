// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "covering/cover_solid.h"
#include "covering/solids.h"

namespace mneme::test {
namespace {

using internal::Excess;
using internal::SolidModel;

TEST_SUITE("unit") {
  TEST_CASE("what no sphere holds is uncovered") {
    const std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {5, 0, 0}};
    const std::vector<Sphere> spheres = {{{0, 0, 0}, 1}, {{2, 0, 0}, 0.5}};
    CHECK(internal::uncovered_fraction(points, spheres) == doctest::Approx(0.25));
    CHECK(internal::uncovered_fraction(points, {}) == 1);
    CHECK(internal::uncovered_fraction({}, {}) == 0);
  }

  TEST_CASE("the excess of a sphere around a box is that of its farthest point") {
    const SolidModel solid(internal::triangulate(make_box({0.2, 0.2, 0.2})));
    const std::vector<Sphere> sphere = {{{0, 0, 0}, 0.1 * std::sqrt(3.0)}};
    const Excess excess = internal::measure_excess(sphere, solid);
    CHECK(excess.max == doctest::Approx(0.1 * (std::sqrt(3.0) - 1)).epsilon(0.01));
    CHECK(excess.mean > 0.3 * excess.max);
    CHECK(excess.mean < excess.max);
  }

  TEST_CASE("skin that another sphere hides does not count, nor does what is inside") {
    const SolidModel solid(internal::triangulate(make_box({0.2, 0.2, 0.2})));
    const std::vector<Sphere> inside = {{{0, 0, 0}, 0.05}};
    CHECK(internal::measure_excess(inside, solid).max == 0);
    const std::vector<Sphere> hidden = {{{0, 0, 0}, 1}, {{0.3, 0, 0}, 0.1}};
    const std::vector<Sphere> alone = {{{0, 0, 0}, 1}};
    CHECK(internal::measure_excess(hidden, solid).mean ==
          doctest::Approx(internal::measure_excess(alone, solid).mean));
  }
}

TEST_SUITE("law") {
  TEST_CASE("samples lie on the surface, as many on each face as its area asks for") {
    const Box box = make_box({0.4, 0.2, 0.1});
    int on_top = 0;
    const auto points = internal::sample_surface(internal::triangulate(box), 10000);
    for (const Vec3& p : points) {
      CHECK((box.half_extents - p.cwiseAbs()).minCoeff() == doctest::Approx(0));
      on_top += p.z() > 0.05 - 1e-9 ? 1 : 0;
    }
    CHECK(on_top / 10000.0 == doctest::Approx(0.08 / 0.28).epsilon(0.05));
  }

  TEST_CASE("samples near the surface are inside, and no deeper than two cells") {
    const SolidModel solid(internal::triangulate(Cylinder{{}, 0.1, 0.3}));
    const auto points = internal::sample_near_surface(solid);
    CHECK(points.size() > 1000);
    for (const Vec3& p : points) {
      CHECK(solid.depth(p) > 0);
      CHECK(solid.depth(p) < 2 * solid.cell_size());
    }
  }
}

}  // namespace
}  // namespace mneme::test
