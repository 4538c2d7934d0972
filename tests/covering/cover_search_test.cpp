// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "covering/cover_search.h"
#include "covering/solids.h"

namespace mneme::test {
namespace {

using internal::Element;
using internal::SolidModel;

Element point_at(double x, double y = 0) {
  const Sphere point{{x, y, 0}, 0};
  return {point, {point}};
}

bool holds_all(const std::vector<Sphere>& spheres, const std::vector<Element>& elements) {
  return std::ranges::all_of(elements, [&](const Element& element) {
    return std::ranges::any_of(spheres, [&](const Sphere& s) { return element.is_within(s); });
  });
}

TEST_SUITE("unit") {
  TEST_CASE("a piece that no proposal holds gets a sphere of its own") {
    const std::vector<Element> elements = {point_at(0), point_at(50)};
    Rng rng(1);
    const auto spheres = internal::choose_spheres({{{0, 0, 0}, 1}}, elements, 1000, rng);
    CHECK(spheres.size() == 2);
    CHECK(holds_all(spheres, elements));
  }
}

TEST_SUITE("law") {
  TEST_CASE("what is chosen holds all pieces, is the same again, and less than greed takes") {
    Rng points(5);
    std::vector<Element> elements;
    std::vector<Sphere> proposals;
    for (int i = 0; i < 300; ++i) {
      elements.push_back(point_at(points.uniform(0, 10), points.uniform(0, 10)));
      proposals.push_back({elements.back().bound.center, points.uniform(0.2, 2)});
    }
    Rng first(2);
    Rng second(2);
    const auto spheres = internal::choose_spheres(proposals, elements, 500000, first);
    const auto again = internal::choose_spheres(proposals, elements, 500000, second);
    CHECK(holds_all(spheres, elements));
    CHECK(spheres.size() < internal::choose_spheres(proposals, elements, 0, first).size());
    REQUIRE(spheres.size() == again.size());
    for (std::size_t i = 0; i < spheres.size(); ++i) CHECK(spheres[i].center == again[i].center);
  }

  TEST_CASE("proposals stick out by no more than the excess") {
    const auto mesh = internal::triangulate(make_box({0.3, 0.2, 0.1}));
    const SolidModel solid(mesh);
    const auto elements = internal::make_elements(mesh, solid, 0.02);
    Rng rng(1);
    const auto proposals =
        internal::propose_spheres(solid, solid.medial_balls(), elements, 0.02, rng);
    CHECK(proposals.size() > 100);
    for (const Sphere& s : proposals) CHECK(s.radius - solid.depth(s.center) <= 0.02 + 1e-9);
  }
}

}  // namespace
}  // namespace mneme::test
