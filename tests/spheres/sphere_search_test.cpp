// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "spheres/sphere_search.h"
#include "spheres/approximate_solid.h"
#include "spheres/solids.h"

#include <iterator>

namespace mneme::test {
namespace {

using internal::Element;
using internal::SolidModel;
using internal::TriangleMesh;

/// Pieces of the surface and of the inside.
std::vector<Element> all_pieces(const TriangleMesh& mesh, const SolidModel& solid, double size) {
  internal::SolidPieces pieces(mesh, solid, size);
  std::ranges::move(pieces.spare, std::back_inserter(pieces.needed));
  return pieces.needed;
}

/// From pieces that are all needed.
std::vector<Sphere> choose(std::vector<Sphere> proposals, const std::vector<Element>& elements,
                           std::int64_t effort, Rng& rng) {
  internal::SolidPieces pieces(elements);
  return internal::choose_spheres(std::move(proposals), pieces, effort, rng);
}
std::vector<Sphere> refine(const std::vector<Sphere>& spheres, const std::vector<Element>& elements,
                           const SolidModel& solid) {
  internal::SolidPieces pieces(elements);
  return internal::refine(spheres, pieces, solid);
}

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
    const std::vector<Element> elements = all_pieces(mesh, solid, 0.03);
    std::vector<Sphere> bounds;
    for (const Element& element : elements) {
      CHECK(element.is_within(element.bound));
      CHECK(element.bound.radius < 0.08);
      bounds.push_back(element.bound);
    }
    CHECK(internal::uncovered_fraction(internal::sample_surface(mesh, 3000), bounds) == 0);
    std::vector<Vec3> centers;
    for (const SolidModel::Voxel& voxel : solid.inner_voxels()) centers.push_back(voxel.center);
    CHECK(internal::uncovered_fraction(centers, bounds) == 0);
  }

  TEST_CASE("smaller pieces are more pieces") {
    const TriangleMesh mesh = internal::triangulate(make_box({0.3, 0.2, 0.1}));
    const SolidModel solid(mesh);
    CHECK(all_pieces(mesh, solid, 0.02).size() > all_pieces(mesh, solid, 0.04).size());
  }
}

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
    const auto spheres = choose({{{0, 0, 0}, 1}}, elements, 1000, rng);
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
      const double y = points.uniform(0, 10), x = points.uniform(0, 10);
      elements.push_back(point_at(x, y));
      proposals.push_back({elements.back().bound.center, points.uniform(0.2, 2)});
    }
    Rng first(2);
    Rng second(2);
    const auto spheres = choose(proposals, elements, 500000, first);
    const auto again = choose(proposals, elements, 500000, second);
    CHECK(holds_all(spheres, elements));
    CHECK(spheres.size() < choose(proposals, elements, 0, first).size());
    REQUIRE(spheres.size() == again.size());
    for (std::size_t i = 0; i < spheres.size(); ++i) CHECK(spheres[i].center == again[i].center);
  }

  TEST_CASE("the inside is contained, too, though most of it is spare") {
    const auto mesh = internal::triangulate(make_box({0.3, 0.2, 0.1}));
    const SolidModel solid(mesh);
    internal::SolidPieces pieces(mesh, solid, 0.01);
    const std::vector<Element> all = all_pieces(mesh, solid, 0.01);
    const std::size_t surface = pieces.needed.size();
    // Small spheres: those at the surface leave the middle bare.
    std::vector<Sphere> proposals;
    for (const Element& element : all) proposals.push_back({element.bound.center, 0.03});
    Rng rng(1);
    const auto chosen = internal::choose_spheres(proposals, pieces, 100000, rng);
    CHECK(holds_all(chosen, all));
    CHECK(pieces.needed.size() > surface);
    CHECK(pieces.needed.size() + pieces.spare.size() == all.size());
    CHECK(pieces.spare.size() > surface);
    CHECK(holds_all(internal::refine(chosen, pieces, solid), pieces.spare));
  }

  TEST_CASE("proposals stick out by no more than the excess") {
    const auto mesh = internal::triangulate(make_box({0.3, 0.2, 0.1}));
    const SolidModel solid(mesh);
    const auto elements = all_pieces(mesh, solid, 0.02);
    Rng rng(1);
    const auto proposals =
        internal::propose_spheres(solid, solid.medial_balls(), elements, 0.02, rng);
    CHECK(proposals.size() > 100);
    for (const Sphere& s : proposals) CHECK(s.radius - solid.depth(s.center) <= 0.02 + 1e-9);
  }
}

double worst_stick_out(const std::vector<Sphere>& spheres, const SolidModel& solid) {
  double worst = 0;
  for (const Sphere& s : spheres) worst = std::max(worst, s.radius - solid.depth(s.center));
  return worst;
}

TEST_SUITE("unit") {
  TEST_CASE("a sphere that nothing needs is dropped") {
    const auto mesh = internal::triangulate(make_box({0.1, 0.1, 0.1}));
    const SolidModel solid(mesh);
    const auto elements = all_pieces(mesh, solid, 0.03);
    const auto spheres = refine({{{0, 0, 0}, 0.2}, {{0, 0, 0}, 0.1}}, elements, solid);
    REQUIRE(spheres.size() == 1);
    CHECK(spheres[0].radius == doctest::Approx(0.05 * std::sqrt(3.0)).epsilon(0.02));
  }
}

TEST_SUITE("law") {
  TEST_CASE("what was held stays held, and spheres stick out less") {
    const auto mesh = internal::triangulate(Cylinder{{}, 0.06, 0.4});
    const SolidModel solid(mesh);
    const auto elements = all_pieces(mesh, solid, 0.015);
    Rng rng(1);
    const auto proposals =
        internal::propose_spheres(solid, solid.medial_balls(), elements, 0.03, rng);
    const auto before = choose(proposals, elements, 1000000, rng);
    const auto after = refine(before, elements, solid);
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
