// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "primitive/passage.h"
#include "geometry/random_shapes.h"
#include "support/lifting_arm.h"

namespace mneme::test {
namespace {

constexpr double kFar = 1e9;

Cylinder upright(const Vec3& center, double radius, double length) {
  return {{Eigen::Matrix3d::Identity(), center}, radius, length};
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("between parallel cylinders the passage is half way up") {
    const Obstacle a{"a", {upright({0.8, 0.2, 0.9}, 0.05, 0.3)}};
    const Obstacle b{"b", {upright({0.8, -0.1, 0.9}, 0.03, 0.3)}};
    const auto passage = internal::find_passage(a, b, kFar);
    REQUIRE(passage.has_value());
    CHECK((passage->a - Vec3(0.8, 0.15, 0.9)).norm() < 1e-6);
    CHECK((passage->b - Vec3(0.8, -0.07, 0.9)).norm() < 1e-6);
    CHECK(passage->width() == doctest::Approx(0.22));
    CHECK((passage->middle() - Vec3(0.8, 0.04, 0.9)).norm() < 1e-6);
  }

  TEST_CASE("a body of many shapes takes part with the one that is closest") {
    const Obstacle shelf{
        "shelf", {box_at({1, 0, 0}, {0.5, 0.5, 0.01}), box_at({1, 0, 1}, {0.5, 0.5, 0.01})}};
    const Obstacle can{"can", {upright({1, 0, 0.7}, 0.05, 0.2)}};
    const auto passage = internal::find_passage(shelf, can, kFar);
    REQUIRE(passage.has_value());
    CHECK(passage->a.z() == doctest::Approx(0.99));
    CHECK(passage->b.z() == doctest::Approx(0.8));
    CHECK(internal::closest_shapes(shelf, can, kFar).a == &shelf.shapes[1]);
  }

  TEST_CASE("bodies that touch, or that are too far apart, have no passage") {
    const Obstacle board{"board", {box_at({1, 0, 0}, {0.5, 0.5, 0.01})}};
    const Obstacle can{"can", {upright({1, 0, 0.11}, 0.05, 0.2)}};
    const Obstacle high{"high", {upright({1, 0, 0.61}, 0.05, 0.2)}};
    CHECK(!internal::find_passage(board, can, kFar).has_value());
    CHECK(!internal::find_passage(board, high, 0.4).has_value());
    CHECK(internal::find_passage(board, high, 0.6).has_value());
  }
}

TEST_SUITE("law") {
  TEST_CASE("a passage is as wide as its bodies are apart, and moves with them") {
    Rng rng(72);
    int found = 0;
    for (int i = 0; i < 400; ++i) {
      const Obstacle a{"a", {random_shape(static_cast<int>(rng.index(kShapeKinds)), rng)}};
      const Obstacle b{"b", {random_shape(static_cast<int>(rng.index(kShapeKinds)), rng)}};
      const auto passage = internal::find_passage(a, b, kFar);
      const double apart = distance(a.shapes[0], b.shapes[0]);
      REQUIRE(passage.has_value() == (apart >= 1e-5));
      if (!passage || apart < 0.05) continue;
      ++found;
      REQUIRE(distance(passage->a, a.shapes[0]) < 1e-9);
      REQUIRE(distance(passage->b, b.shapes[0]) < 1e-9);
      REQUIRE(passage->width() > apart - 2e-3);
      REQUIRE(passage->width() < apart + 2e-2);
      const auto swapped = internal::find_passage(b, a, kFar);
      REQUIRE((swapped->middle() - passage->middle()).norm() < 1e-2);
      const Transform motion = random_pose(rng, 2.0);
      const auto moved =
          internal::find_passage(moved_obstacle(motion, a), moved_obstacle(motion, b), kFar);
      REQUIRE((moved->middle() - motion * passage->middle()).norm() < 1e-6);
    }
    CHECK(found > 100);
  }
}

}  // namespace mneme::test
