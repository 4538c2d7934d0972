// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/random_shapes.h"
#include "support/kinds.h"
#include "support/lifting_arm.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mneme::test {
namespace {

Obstacle post(const std::string& name, double x, double y, double radius = 0.04) {
  return {name, {Cylinder{{Eigen::Matrix3d::Identity(), {x, y, 0.6}}, radius, 0.2}}};
}

/// Two boards and a back, with two posts between the boards, and a third post far behind.
Scene shelf() {
  const Obstacle bookcase{
      "bookcase",
      {box_at({1, 0, 0.49}, {0.3, 0.4, 0.01}), box_at({1, 0, 0.71}, {0.3, 0.4, 0.01}),
       box_at({1.31, 0, 0.6}, {0.01, 0.4, 0.12})}};
  return {
      "shelf",
      {bookcase, post("left", 0.85, 0.11), post("right", 0.85, -0.11), post("behind", 1.22, 0.0)}};
}

std::vector<LocalPrimitive> gaps(const Scene& scene, std::optional<double> max_gap = {}) {
  const Robot robot = lifting_arm();
  const auto result = decompose({robot, scene}, {"gaps", max_gap});
  REQUIRE_MESSAGE(result.has_value(), (result ? "" : result.error().message));
  return *result;
}

double key_error(const PrimitiveKey& a, const PrimitiveKey& b) {
  REQUIRE(a.size() == kGapKeySize);
  return std::sqrt(similarity_error(kind_named("gaps"), a, b));
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a passage comes with the body that bounds it, and without what is behind") {
    const auto found = gaps(shelf());
    REQUIRE(found.size() == 1);
    CHECK(found[0].obstacles == std::vector<int>{1, 2, 0});
    CHECK(found[0].gap == doctest::Approx(0.14));
    const Vec3 middle = Vec3(0.85, 0, 0.6) - turning_axis();
    CHECK(found[0].to_scene.rotation == doctest::Approx(std::atan2(middle.y(), middle.x())));
    CHECK(found[0].to_scene.lift == doctest::Approx(0.6));
    CHECK(found[0].key[0] == doctest::Approx(std::hypot(middle.x(), middle.y())));
    CHECK(std::abs(found[0].key[1]) < 1e-12);
    CHECK(std::abs(found[0].key[2]) < 1e-12);
  }

  TEST_CASE("pairs that touch, that are far apart or too narrow for the robot are no passages") {
    CHECK(gaps({"touching", {post("a", 0.85, 0.04), post("b", 0.85, -0.04)}}).empty());
    CHECK(gaps({"far", {post("a", 0.85, 0.2), post("b", 0.85, -0.2)}}).empty());
    CHECK(gaps({"far", {post("a", 0.85, 0.2), post("b", 0.85, -0.2)}}, 0.33).size() == 1);
    // The thinnest shape of the arm has a diameter of 0.06 m.
    CHECK(gaps({"narrow", {post("a", 0.85, 0.069), post("b", 0.85, -0.069)}}).empty());
    CHECK(gaps({"wide", {post("a", 0.85, 0.071), post("b", 0.85, -0.071)}}).size() == 1);
  }

  TEST_CASE("a passage with something in its middle is none") {
    const Scene open{"open", {post("a", 0.85, 0.15), post("b", 0.85, -0.15)}};
    CHECK(gaps(open).size() == 1);
    Scene blocked = open;
    blocked.obstacles.push_back(post("c", 0.86, 0, 0.01));
    CHECK(std::ranges::none_of(gaps(blocked), [](const LocalPrimitive& found) {
      return found.obstacles[0] == 0 && found.obstacles[1] == 1;
    }));
  }

  TEST_CASE("a key holds the middle and a third of the distances around it") {
    const std::vector<Obstacle> floor = {{"floor", {box_at({0, 0, -1}, {5, 5, 0.95})}}};
    const PrimitiveKey key = gap_key(floor, {1, 2, 0}, Eigen::Matrix3d::Identity());
    REQUIRE(key.size() == kGapKeySize);
    CHECK(key[0] == 1);
    CHECK(key[1] == 2);
    // The last axis counts fastest: below, at and above the middle.
    CHECK(key[3] == 0);
    CHECK(key[4] == doctest::Approx(0.05 / 3));
    CHECK(key[5] == doctest::Approx(0.15 / 3));
    const PrimitiveKey nothing = gap_key({}, Vec3::Zero(), Eigen::Matrix3d::Identity());
    CHECK(nothing[3] == doctest::Approx(kGapReach / 3));
  }
}

TEST_SUITE("law") {
  TEST_CASE("what the symmetric joints undo changes neither the key nor the members") {
    const SymmetricJoints joints = find_symmetric_joints(lifting_arm());
    const auto here = gaps(shelf());
    Rng rng(73);
    for (int i = 0; i < 50; ++i) {
      const Symmetry motion{rng.uniform(-3, 3), false, rng.uniform(-0.4, 0.4)};
      const auto there = gaps(moved_scene(transform_of(joints, motion), shelf()));
      REQUIRE(there.size() == 1);
      REQUIRE(there[0].obstacles == here[0].obstacles);
      REQUIRE(key_error(here[0].key, there[0].key) < 1e-6);
      REQUIRE(there[0].to_scene.lift - here[0].to_scene.lift == doctest::Approx(motion.lift));
    }
  }

  TEST_CASE("the order of the obstacles, and what is out of reach, do not change the key") {
    const PrimitiveKey key = gaps(shelf())[0].key;
    Scene turned = shelf();
    std::ranges::reverse(turned.obstacles);
    CHECK(key_error(gaps(turned)[0].key, key) < 1e-9);
    Scene more = shelf();
    more.obstacles.push_back({"wall", {box_at({-1, 0, 0.6}, {0.1, 2, 1})}});
    std::get<Box>(more.obstacles[0].shapes[2]).half_extents.y() = 3;
    CHECK(key_error(gaps(more)[0].key, key) < 1e-9);
  }

  TEST_CASE("surfaces that move by less than e change the key's distances by less than sqrt(3) e") {
    Rng rng(74);
    for (int i = 0; i < 200; ++i) {
      std::vector<Obstacle> before, after;
      const double most = rng.uniform(0.001, 0.05);
      for (int k = 0; k < 3; ++k) {
        before.push_back({"o", {random_shape(static_cast<int>(rng.index(kShapeKinds)), rng)}});
        const Vec3 shift = most / std::sqrt(3) * random_vector(rng, 1.0);
        after.push_back(moved_obstacle({Eigen::Matrix3d::Identity(), shift}, before.back()));
      }
      const Vec3 middle = random_vector(rng, 1.5);
      const Eigen::Matrix3d rotation = random_pose(rng, 1.0).rotation;
      REQUIRE(key_error(gap_key(before, middle, rotation), gap_key(after, middle, rotation)) <=
              std::sqrt(3.0) * most + 1e-9);
    }
  }

  TEST_CASE("a primitive's own scene has the same primitive") {
    const Scene scene = shelf();
    const LocalPrimitive primitive = gaps(scene)[0];
    Scene own{"own", {}};
    for (const int index : primitive.obstacles) {
      own.obstacles.push_back(scene.obstacles[static_cast<std::size_t>(index)]);
    }
    const auto again = gaps(own);
    REQUIRE(again.size() == 1);
    CHECK(again[0].obstacles == std::vector<int>{0, 1, 2});
    CHECK(key_error(again[0].key, primitive.key) == 0);
  }
}

}  // namespace mneme::test
