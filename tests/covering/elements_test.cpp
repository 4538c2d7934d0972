// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "covering/cover_search.h"
#include "covering/cover_solid.h"
#include "covering/solids.h"

namespace mneme::test {
namespace {

using internal::Element;
using internal::SolidModel;
using internal::TriangleMesh;

TEST_SUITE("unit") {
  TEST_CASE("the reach of a piece is that of its farthest ball") {
    const Element element{{{0, 0, 0}, 3}, {{{1, 0, 0}, 0.5}, {{-2, 0, 0}, 0.25}}};
    CHECK(element.reach_from({0, 0, 0}) == doctest::Approx(2.25));
    CHECK(element.is_within({{0, 0, 0}, 2.3}));
    CHECK_FALSE(element.is_within({{0, 0, 0}, 2.2}));
    CHECK_FALSE(element.is_within({{9, 0, 0}, 2.3}));
  }
}

TEST_SUITE("law") {
  TEST_CASE("spheres that hold all pieces hold all of the surface and the inside") {
    const TriangleMesh mesh = internal::triangulate(make_box({0.3, 0.2, 0.1}));
    const SolidModel solid(mesh);
    const std::vector<Element> elements = internal::make_elements(mesh, solid, 0.03);
    std::vector<Sphere> bounds;
    for (const Element& element : elements) {
      CHECK(element.is_within(element.bound));
      CHECK(element.bound.radius < 0.08);
      bounds.push_back(element.bound);
    }
    CHECK(internal::uncovered_fraction(internal::sample_surface(mesh, 3000), bounds) == 0);
    std::vector<Vec3> centers;
    for (const SolidModel::Cell& cell : solid.inner_cells()) centers.push_back(cell.center);
    CHECK(internal::uncovered_fraction(centers, bounds) == 0);
  }

  TEST_CASE("smaller pieces are more pieces") {
    const TriangleMesh mesh = internal::triangulate(make_box({0.3, 0.2, 0.1}));
    const SolidModel solid(mesh);
    CHECK(internal::make_elements(mesh, solid, 0.02).size() >
          internal::make_elements(mesh, solid, 0.04).size());
  }
}

}  // namespace
}  // namespace mneme::test
