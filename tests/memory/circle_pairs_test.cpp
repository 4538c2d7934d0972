// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/kinds.h"
#include "memory/random_pairs.h"

#include <limits>

namespace mneme::test {
namespace {

std::vector<LocalPrimitive> pairs(const std::vector<std::array<double, 3>>& circles,
                                  double max_gap = 1.0) {
  const Robot robot = planar8();
  const Scene scene = make_circle_scene("circles", circles);
  return require(decompose({robot, scene}, {{}, max_gap}));
}

Error refusal(const Robot& robot, const Scene& scene) {
  return require_error(decompose({robot, scene}, of_kind("pairs")));
}

/// Two links in the plane; what the words stand for differs from test to test.
Robot two_link_arm(const std::string& first_origin, const std::string& second_origin,
                   const std::string& second_axis, const std::string& capsule_origin) {
  const std::string capsule = "<collision><origin " + capsule_origin +
                              "/><geometry><capsule radius='0.001' length='1'/></geometry>"
                              "</collision>";
  const std::string text =
      "<robot name='odd'><link name='base'/><link name='one'>" + capsule +
      "</link><link name='two'>" + capsule +
      "</link><joint name='j1' type='continuous'><parent link='base'/><child link='one'/><origin " +
      first_origin + "/><axis xyz='0 0 1'/></joint><joint name='j2' type='continuous'>" +
      "<parent link='one'/><child link='two'/><origin " + second_origin + "/><axis xyz='" +
      second_axis + "'/></joint></robot>";
  return require(parse_robot(text, "odd.urdf"));
}

constexpr const char* kAlongX = "xyz='0.5 0 0' rpy='0 1.5707963267948966 0'";

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("pairs closer than the maximal gap are found in scene order") {
    const auto found = pairs({{3, 1.2, 1}, {3, -1.2, 1}, {-3, 0, 1}, {5.5, 0, 1}}, 1.0);
    REQUIRE(found.size() == 3);
    CHECK(found[0].obstacles == std::vector<int>{0, 1});
    CHECK(found[1].obstacles == std::vector<int>{0, 3});
    CHECK(found[2].obstacles == std::vector<int>{1, 3});
    CHECK(found[0].gap == doctest::Approx(0.4));
    CHECK(largest_difference(moved_key(found[1].to_scene, found[1].key),
                             PrimitiveKey{3, 1.2, 1, 5.5, 0, 1}) < 1e-14);
  }

  TEST_CASE("circles that touch or overlap form no primitive") {
    CHECK(pairs({{3, 1, 1}, {3, -1, 1}}).empty());
    CHECK(pairs({{3, 1, 1.5}, {3, -1, 1}}).empty());
    CHECK(pairs({{3, 1, 1}, {3, 1, 1}}).empty());
  }

  TEST_CASE("a gap as wide as the maximum still counts") {
    CHECK(pairs({{3, 1, 0.5}, {3, -1, 0.5}}, 1.0).size() == 1);
    CHECK(pairs({{3, 1, 0.5}, {3, -1, 0.5}}, 0.99).empty());
  }

  TEST_CASE("a pair whose gap is out of reach is skipped") {
    // The arm is 11.6 m long; the point of the gap that is nearest to the base decides.
    CHECK(pairs({{11.5, 1.1, 1}, {11.5, -1.1, 1}}).size() == 1);
    CHECK(pairs({{11.7, 1.1, 1}, {11.7, -1.1, 1}}).empty());
    CHECK(pairs({{10, 0, 1}, {12.9, 0, 1}}).size() == 1);
    CHECK(pairs({{10.7, 0, 1}, {13, 0, 1}}).empty());
  }

  TEST_CASE("an empty scene and a single circle have no primitives") {
    CHECK(pairs({}).empty());
    CHECK(pairs({{3, 1, 1}}).empty());
  }

  TEST_CASE("an obstacle that is no circle is refused by name") {
    Scene scene = make_circle_scene("s", {{3, 1, 1}});
    scene.obstacles.push_back({"crate", {Box{{}, Vec3(1, 1, 1)}}});
    Error error = refusal(planar8(), scene);
    CHECK(error.code == ErrorCode::unsupported);
    CHECK(contains(error.message, "'crate'"));
    CHECK(contains(error.message, "box"));

    scene.obstacles.back() = {"dumbbell", {Sphere{Vec3(1, 0, 0), 1}, Sphere{Vec3(3, 0, 0), 1}}};
    error = refusal(planar8(), scene);
    CHECK(error.code == ErrorCode::unsupported);
    CHECK(contains(error.message, "'dumbbell' has 2 shapes"));

    scene.obstacles.back() = {"balloon", {Sphere{Vec3(3, 0, 0.5), 1}}};
    error = refusal(planar8(), scene);
    CHECK(error.code == ErrorCode::unsupported);
    CHECK(contains(error.message, "'balloon' is centred at z = 0.5"));
  }

  TEST_CASE("a circle that is not finite or has no size is refused by name") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const Sphere& sphere : {Sphere{Vec3(nan, 0, 0), 1}, Sphere{Vec3(3, 0, 0), nan},
                                 Sphere{Vec3(3, 0, 0), 0}, Sphere{Vec3(3, 0, 0), -1}}) {
      const Error error = refusal(planar8(), Scene{"s", {{"ghost", {sphere}}}});
      CHECK(error.code == ErrorCode::invalid);
      CHECK(contains(error.message, "'ghost'"));
    }
  }

  TEST_CASE("a robot that rotations and mirror images do not fit is refused with the reason") {
    const Scene scene = make_circle_scene("s", {{3, 1, 0.9}, {3, -1, 0.9}});
    const Robot robot = two_link_arm("xyz='0 0 0'", "xyz='1 0 0'", "0 0 1", kAlongX);
    REQUIRE(decompose({robot, scene}));

    Error error = refusal(two_link_arm("xyz='0 0 0'", "xyz='1 0 0'", "0 1 0", kAlongX), scene);
    CHECK(error.code == ErrorCode::unsupported);
    CHECK(contains(error.message, "'odd': the robot is not planar"));

    error = refusal(two_link_arm("xyz='0.3 0 0'", "xyz='1 0 0'", "0 0 1", kAlongX), scene);
    CHECK(contains(error.message, "joint 'j1' does not turn link 'one' about the base"));

    error =
        refusal(two_link_arm("xyz='0 0 0'", "xyz='1 0 0' rpy='0 0 0.5'", "0 0 1", kAlongX), scene);
    CHECK(contains(error.message, "link 'two' is not its own mirror image"));

    error = refusal(two_link_arm("xyz='0 0 0'", "xyz='1 0 0'", "0 0 1",
                                 "xyz='0.5 0.1 0' rpy='0 1.5707963267948966 0'"),
                    scene);
    CHECK(contains(error.message, "link 'one' is not its own mirror image"));
  }
}

TEST_SUITE("law") {
  TEST_CASE("a scene moved by a symmetry has primitives with the same keys") {
    Rng rng(31);
    int found = 0;
    for (int i = 0; i < 50; ++i) {
      std::vector<std::array<double, 3>> circles;
      std::vector<std::array<double, 3>> moved_circles;
      const Symmetry motion = random_symmetry(rng);
      for (int k = 0; k < 6; ++k) {
        const PrimitiveKey circle = {rng.uniform(-7, 7), rng.uniform(-7, 7), rng.uniform(0.5, 1.5)};
        const PrimitiveKey there = moved_key(motion, circle);
        circles.push_back({circle[0], circle[1], circle[2]});
        moved_circles.push_back({there[0], there[1], there[2]});
      }
      const auto before = pairs(circles);
      const auto after = pairs(moved_circles);
      REQUIRE(before.size() == after.size());
      for (std::size_t k = 0; k < before.size(); ++k) {
        REQUIRE(before[k].obstacles == after[k].obstacles);
        REQUIRE(pair_error(before[k].key, after[k].key) < 1e-20);
      }
      found += static_cast<int>(before.size());
    }
    CHECK(found > 25);
  }
}

}  // namespace mneme::test
