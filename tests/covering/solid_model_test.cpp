// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "covering/solid_model.h"
#include "covering/solids.h"

namespace mneme::test {
namespace {

using internal::SolidModel;
using internal::TriangleMesh;

TriangleMesh cube(double size, const Vec3& center = Vec3::Zero()) {
  return internal::triangulate(make_box(Vec3::Constant(size), center));
}

TEST_SUITE("unit") {
  TEST_CASE("where parts overlap, inner walls do not count") {
    const SolidModel solid(joined(cube(0.2), cube(0.2, {0.1, 0, 0})));
    CHECK(solid.contains({0.05, 0.01, 0.02}));
    CHECK(solid.contains({-0.05, 0, 0}));
    CHECK(solid.depth({0.05, 0, 0}) == doctest::Approx(0.1).epsilon(1e-6));
  }

  TEST_CASE("a closed cavity is inside") {
    const SolidModel solid(joined(cube(0.4), cube(0.2)));
    CHECK(solid.contains({0.01, 0.02, 0.03}));
    CHECK(solid.depth({0, 0, 0}) == doctest::Approx(0.2));
  }

  TEST_CASE("a tube without caps is full") {
    const SolidModel solid(make_tube(0.05, 0.4));
    CHECK(solid.contains({0.01, 0.01, 0.05}));
    CHECK_FALSE(solid.contains({0.01, 0.01, 0.26}));
    CHECK_FALSE(solid.contains({0.06, 0, 0}));
  }

  TEST_CASE("a shallow tray is hollow") {
    TriangleMesh tray = internal::triangulate(make_box({0.4, 0.4, 0.1}));
    std::erase_if(tray, [](const internal::Triangle& t) {
      return t.a.z() > 0 && t.b.z() > 0 && t.c.z() > 0;
    });
    const SolidModel solid(tray);
    CHECK_FALSE(solid.contains({0, 0, 0.03}));
    CHECK(solid.depth({0, 0, 0}) == doctest::Approx(-0.05));
  }

  TEST_CASE("a single triangle has no inside, but a distance") {
    const SolidModel solid({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}});
    CHECK(solid.inner_cells().empty());
    CHECK(solid.medial_balls().empty());
    CHECK(solid.depth({0.2, 0.2, 0.3}) == doctest::Approx(-0.3));
  }
}

TEST_SUITE("law") {
  TEST_CASE("depth in a box is the distance to its nearest face, and below zero outside") {
    const Box box = make_box({0.3, 0.2, 0.1}, {0.5, 0, 0});
    const SolidModel solid(internal::triangulate(box));
    Rng rng(11);
    for (int i = 0; i < 500; ++i) {
      const Vec3 p = random_point(rng, 0.3) + Vec3(0.5, 0, 0);
      const double inside = (box.half_extents - (p - Vec3(0.5, 0, 0)).cwiseAbs()).minCoeff();
      const double expected = inside > 0 ? inside : -distance(p, box);
      CHECK(solid.depth(p) == doctest::Approx(expected).epsilon(1e-6));
    }
  }

  TEST_CASE("cells fill the volume, and whole ones lie inside altogether") {
    const SolidModel solid(internal::triangulate(make_box({0.3, 0.2, 0.1})));
    const double cell_volume = std::pow(solid.cell_size(), 3);
    CHECK(static_cast<double>(solid.inner_cells().size()) * cell_volume ==
          doctest::Approx(0.006).epsilon(0.06));
    for (const SolidModel::Cell& cell : solid.inner_cells()) {
      if (cell.is_whole) CHECK(solid.depth(cell.center) >= 0.86 * solid.cell_size());
    }
  }

  TEST_CASE("every ball inside lies, but for the grid, in a medial one") {
    const SolidModel solid(internal::triangulate(make_box({0.3, 0.2, 0.1})));
    const std::vector<Sphere> medial = solid.medial_balls();
    CHECK(medial.size() < solid.inner_cells().size() / 4);
    for (std::size_t i = 0; i < solid.inner_cells().size(); i += 50) {
      const Vec3 center = solid.inner_cells()[i].center;
      const double radius = solid.depth(center);
      CHECK(std::ranges::any_of(medial, [&](const Sphere& ball) {
        return (ball.center - center).norm() + radius <= ball.radius + 2 * solid.cell_size();
      }));
    }
  }
}

}  // namespace
}  // namespace mneme::test
