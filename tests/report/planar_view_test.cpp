// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/picture.h"
#include "report/report_support.h"

#include <numbers>

namespace mneme::internal {
namespace {

using test::require;

TEST_SUITE("unit") {
  TEST_CASE("The middle of the bounds is the middle of the panel, and y points upwards") {
    const PlanarView view({-1, 3, 2, 4}, {10, 20}, 400);
    const Point middle = view.pixel({1, 3});
    CHECK(middle.x == doctest::Approx(210));
    CHECK(middle.y == doctest::Approx(20 + view.height() / 2));
    CHECK(view.pixel({1, 4}).y < middle.y);
    CHECK(view.pixel({2, 3}).x > middle.x);
  }

  TEST_CASE("A point alone still has a scale") {
    Bounds bounds;
    bounds.include({1, 1});
    const PlanarView view(bounds, {0, 0}, 100);
    CHECK(view.scale() > 0);
    CHECK(view.pixel({1, 1}).x == doctest::Approx(50));
  }

  TEST_CASE("Bounds that do not meet have nothing in common") {
    CHECK(Bounds{0, 1, 0, 1}.clipped({2, 3, 0, 1}).is_empty());
    const Bounds common = Bounds{0, 2, 0, 2}.clipped({1, 3, -1, 1});
    CHECK_FALSE(common.is_empty());
    CHECK(common.width() == doctest::Approx(1));
    CHECK(common.height() == doctest::Approx(1));
    CHECK(Bounds{}.is_empty());
  }
}

TEST_SUITE("law") {
  TEST_CASE("Whatever the bounds, they fit into the panel and the aspect is equal") {
    Rng rng(3);
    for (int round = 0; round < 500; ++round) {
      CAPTURE(round);
      Bounds bounds;
      for (int i = 0; i < 3; ++i)
        bounds.include({rng.uniform(-9, 9), rng.uniform(-1, 1) * rng.uniform(0, 20)});
      const PlanarView view(bounds, {5, 7}, 300);
      for (const Point& corner :
           {Point{bounds.left, bounds.bottom}, Point{bounds.right, bounds.top}}) {
        const Point at = view.pixel(corner);
        CHECK(at.x > 5);
        CHECK(at.x < 305);
        CHECK(at.y > 7);
        CHECK(at.y < 7 + view.height());
      }
      CHECK(view.pixel({1, 0}).x - view.pixel({0, 0}).x == doctest::Approx(view.scale()));
      CHECK(view.pixel({0, 0}).y - view.pixel({0, 1}).y == doctest::Approx(view.scale()));
    }
  }
}

double area(const Polygon& polygon) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point& a = polygon[i];
    const Point& b = polygon[(i + 1) % polygon.size()];
    twice += a.x * b.y - a.y * b.x;
  }
  return twice / 2;
}

Polygon polygon_of(const Shape& shape) {
  const auto outline = require(planar_outline(shape));
  REQUIRE(std::holds_alternative<Polygon>(outline));
  return std::get<Polygon>(outline);
}

TEST_SUITE("unit") {
  TEST_CASE("A sphere is cut where the plane cuts it") {
    const auto outline = require(planar_outline(Sphere{{1, 2, 3}, 5}));
    const Disc disc = std::get<Disc>(outline);
    CHECK(disc.center.x == 1);
    CHECK(disc.center.y == 2);
    CHECK(disc.radius == doctest::Approx(4));
  }

  TEST_CASE("Shapes beside the plane have no outline") {
    CHECK_FALSE(planar_outline(Sphere{{0, 0, 2}, 1.9}));
    CHECK_FALSE(planar_outline(Box{{Eigen::Matrix3d::Identity(), {0, 0, 1}}, {1, 1, 0.9}}));
    CHECK_FALSE(planar_outline(Cylinder{{Eigen::Matrix3d::Identity(), {0, 0, -1}}, 1, 1.9}));
    CHECK_FALSE(planar_outline(Capsule{{0, 0, 1}, {1, 0, 1}, 0.9}));
  }

  TEST_CASE("An upright box is its rectangle, turned as it is") {
    const Transform pose{rotation_about(Vec3::UnitZ(), 0.3), {1, 1, 0.2}};
    const Polygon polygon = polygon_of(Box{pose, {1, 2, 0.5}});
    CHECK(polygon.size() == 4);
    CHECK(area(polygon) == doctest::Approx(8));
  }

  TEST_CASE("An upright cylinder is its circle, a lying one its rectangle") {
    const Polygon circle = polygon_of(Cylinder{{}, 2, 1});
    CHECK(area(circle) == doctest::Approx(4 * std::numbers::pi).epsilon(0.01));
    const Transform lying{rotation_about(Vec3::UnitX(), std::numbers::pi / 2), Vec3::Zero()};
    CHECK(area(polygon_of(Cylinder{lying, 2, 3})) == doctest::Approx(12).epsilon(0.01));
  }

  TEST_CASE("A capsule has round ends") {
    const Polygon polygon = polygon_of(Capsule{{0, 0, 0}, {3, 0, 0}, 1});
    CHECK(area(polygon) == doctest::Approx(6 + std::numbers::pi).epsilon(0.01));
    const Bounds bounds = bounds_of(Outline(polygon));
    CHECK(bounds.left == doctest::Approx(-1));
    CHECK(bounds.right == doctest::Approx(4));
  }

  TEST_CASE("The bounds of a disc are its square") {
    const Bounds bounds = bounds_of(Outline(Disc{{1, 2}, 3}));
    CHECK(bounds.left == -2);
    CHECK(bounds.top == 5);
  }
}

}  // namespace

}  // namespace mneme::internal
