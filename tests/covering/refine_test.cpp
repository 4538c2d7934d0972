// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "covering/cover_search.h"
#include "covering/solids.h"

namespace mneme::test {
namespace {

using internal::Element;
using internal::SolidModel;

double worst_stick_out(const std::vector<Sphere>& spheres, const SolidModel& solid) {
  double worst = 0;
  for (const Sphere& s : spheres) worst = std::max(worst, s.radius - solid.depth(s.center));
  return worst;
}

TEST_SUITE("unit") {
  TEST_CASE("a sphere that nothing needs is dropped") {
    const auto mesh = internal::triangulate(make_box({0.1, 0.1, 0.1}));
    const SolidModel solid(mesh);
    const auto elements = internal::make_elements(mesh, solid, 0.03);
    const auto spheres = internal::refine({{{0, 0, 0}, 0.2}, {{0, 0, 0}, 0.1}}, elements, solid);
    REQUIRE(spheres.size() == 1);
    CHECK(spheres[0].radius == doctest::Approx(0.05 * std::sqrt(3.0)).epsilon(0.02));
  }
}

TEST_SUITE("law") {
  TEST_CASE("what was held stays held, and spheres stick out less") {
    const auto mesh = internal::triangulate(Cylinder{{}, 0.06, 0.4});
    const SolidModel solid(mesh);
    const auto elements = internal::make_elements(mesh, solid, 0.015);
    Rng rng(1);
    const auto proposals =
        internal::propose_spheres(solid, solid.medial_balls(), elements, 0.03, rng);
    const auto before = internal::choose_spheres(proposals, elements, 1000000, rng);
    const auto after = internal::refine(before, elements, solid);
    CHECK(after.size() <= before.size());
    CHECK(worst_stick_out(after, solid) < worst_stick_out(before, solid));
    for (const Element& element : elements) {
      CHECK(std::ranges::any_of(after, [&](const Sphere& s) {
        return element.is_within({s.center, s.radius + 1e-12});
      }));
    }
  }
}

}  // namespace
}  // namespace mneme::test
