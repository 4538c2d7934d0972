// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/planar_view.h"

#include "report/report_support.h"

namespace mneme::internal {
namespace {

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

}  // namespace
}  // namespace mneme::internal
