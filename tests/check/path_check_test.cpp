// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/report.h"

#include "geometry/box_surface.h"
#include "report/report_support.h"

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace mneme {
namespace {

CollisionChecker checker_for(const std::vector<std::array<double, 3>>& circles, int joints = 3) {
  auto checker =
      CollisionChecker::make(test::unit_arm(joints), make_circle_scene("scene", circles));
  REQUIRE_MESSAGE(checker.has_value(), (checker ? "" : checker.error().message));
  return *checker;
}

TEST_SUITE("unit") {
  TEST_CASE("A path past an obstacle is free, one through it is not") {
    const CollisionChecker checker = checker_for({{0, 2, 0.2}});
    CHECK(is_path_free(checker.robot(), checker.scene(), {{0, 0, 0}, {1, 0.2, 0}}, 0.01));
    CHECK_FALSE(is_path_free(checker.robot(), checker.scene(), {{0.5, 0, 0}, {2.5, 0, 0}}, 0.01));
  }

  TEST_CASE("Both ends count") {
    const CollisionChecker checker = checker_for({{2, 0, 0.2}});
    CHECK_FALSE(is_path_free(checker.robot(), checker.scene(), {{0, 0, 0}, {1, 0, 0}}, 0.01));
    CHECK_FALSE(is_path_free(checker.robot(), checker.scene(), {{1, 0, 0}, {0, 0, 0}}, 0.01));
    CHECK_FALSE(is_path_free(checker.robot(), checker.scene(), {{0, 0, 0}}, 0.01));
    CHECK(is_path_free(checker.robot(), checker.scene(), {{1, 0, 0}}, 0.01));
  }

  TEST_CASE("What a coarse resolution jumps over, a fine one finds") {
    const CollisionChecker checker = checker_for({{3 * std::cos(0.31), 3 * std::sin(0.31), 0.01}});
    const Path path = {{0, 0, 0}, {1, 0, 0}};
    CHECK(is_path_free(checker.robot(), checker.scene(), path, 0.25));
    CHECK_FALSE(is_path_free(checker.robot(), checker.scene(), path, 0.002));
    CHECK_FALSE(is_path_free(checker.robot(), checker.scene(), path, 1e-300));
    CHECK(is_path_free(checker.robot(), checker.scene(), {{0, 0, 0}, {0.2, 0, 0}}, 1e-300));
  }

  TEST_CASE("A continuous joint takes the shorter way round") {
    const std::vector<std::array<double, 3>> ahead = {{2, 0, 0.2}};
    const std::vector<std::array<double, 3>> behind = {{-2, 0, 0.2}};
    const Path path = {{2.5, 0, 0}, {-2.5, 0, 0}};
    CHECK(is_path_free(checker_for(ahead).robot(), checker_for(ahead).scene(), path, 0.01));
    CHECK_FALSE(is_path_free(checker_for(behind).robot(), checker_for(behind).scene(), path, 0.01));
  }

  TEST_CASE("An empty path, a state outside the limits and a senseless resolution are not free") {
    const CollisionChecker checker = checker_for({});
    CHECK_FALSE(is_path_free(checker.robot(), checker.scene(), {}, 0.01));
    CHECK_FALSE(is_path_free(checker.robot(), checker.scene(), {{0, 0, 0}, {0, 4, 0}}, 0.01));
    CHECK_FALSE(is_path_free(checker.robot(), checker.scene(),
                             {{0, 0, std::numeric_limits<double>::quiet_NaN()}}, 0.01));
    CHECK_FALSE(is_path_free(checker.robot(), checker.scene(), {{0, 0}}, 0.01));
    CHECK_FALSE(is_path_free(checker.robot(), checker.scene(), {{0, 0, 0}}, 0));
    CHECK(is_path_free(checker.robot(), checker.scene(), {{0, 0, 0}, {0, 0, 0}}, 0.01));
  }
}

/// A box as a mesh, in a sphere that is far larger.
Link boxed_link(const std::string& name, const Vec3& half_extents) {
  const double radius = 3 * half_extents.norm();
  const Mesh surface = {
      {}, std::make_shared<Parts<Triangle>>(test::surface_of(Box{{}, half_extents})), 0};
  Link link;
  link.name = name;
  link.spheres = {{Vec3::Zero(), radius}};
  link.approximation = SphereApproximation{surface, 1, 0, radius};
  return link;
}

/// Two cubes of 0.2 m with a gap of 0.1 m at 0: the first joint slides one cube from the other, the
/// second turns it about z.
Robot sliding_cubes() {
  Robot::Parts parts;
  parts.name = "cubes";
  parts.links = {boxed_link("fixed", Vec3::Constant(0.1)), Link{},
                 boxed_link("moving", Vec3::Constant(0.1))};
  parts.links[1].name = "carriage";
  Joint& slide = parts.joints.emplace_back();
  slide.name = "slide";
  slide.type = JointType::prismatic;
  slide.parent_link = 0;
  slide.child_link = 1;
  slide.axis = Vec3::UnitX();
  slide.origin.translation = {0.3, 0, 0};
  slide.lower = -0.3;
  slide.upper = 0.3;
  Joint& turn = parts.joints.emplace_back();
  turn.name = "turn";
  turn.type = JointType::revolute;
  turn.parent_link = 1;
  turn.child_link = 2;
  turn.axis = Vec3::UnitZ();
  turn.lower = -3;
  turn.upper = 3;
  parts.allowed_pairs.emplace();
  return test::require(make_robot(std::move(parts)));
}

CollisionChecker checker_of_cubes() {
  Scene scene;
  scene.exact_pairs = {{"fixed", "moving"}};
  return test::require(CollisionChecker::make(sliding_cubes(), scene));
}

TEST_SUITE("unit") {
  TEST_CASE("Links checked by exact geometry may approach from millimetres apart into contact") {
    const CollisionChecker checker = checker_of_cubes();
    const auto is_free = [&](const Path& path) {
      return is_path_free(checker.robot(), checker.scene(), path, 0.001);
    };
    // The middle state is 0.04 m apart, the last one in contact.
    CHECK_FALSE(is_free({{0, 0}, {-0.12, 0}}));
    CHECK(is_free({{0, 0}, {-0.095, 0}}));
    CHECK(is_free({{-0.098, 0}, {0.3, 0}}));
    // A corner of the turning cube passes 0.002 m in front of the other, or touches it at 0.45 rad.
    CHECK(is_free({{-0.0566, 0}, {-0.0566, 1.57}}));
    CHECK(is_free({{-0.0666, 0}, {-0.0666, 0.43}}));
    CHECK_FALSE(is_free({{-0.0666, 0}, {-0.0666, 0.6}}));
  }
}

/// A lift, a boom that turns, and two arms at its end, of which one follows the other.
constexpr const char* kLift = R"(<robot name="lift">
  <link name="base"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
  <link name="boom">
    <collision><origin rpy="0 1.5708 0" xyz="0.25 0 0"/>
      <geometry><capsule radius="0.04" length="0.4"/></geometry></collision></link>
  <link name="arm"><collision><origin xyz="0 0 0.3"/>
    <geometry><capsule radius="0.04" length="0.5"/></geometry></collision></link>
  <link name="follower"><collision><origin xyz="0 0 -0.3"/>
    <geometry><sphere radius="0.15"/></geometry></collision></link>
  <joint name="z" type="prismatic"><parent link="base"/><child link="column"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="0.8" effort="1" velocity="1"/></joint>
  <link name="column"/>
  <joint name="turn" type="continuous"><parent link="column"/><child link="boom"/>
    <axis xyz="0 0 1"/></joint>
  <joint name="bend" type="revolute"><parent link="boom"/><child link="arm"/>
    <origin xyz="0.5 0 0"/><axis xyz="1 0.4 0"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <joint name="follow" type="revolute"><parent link="boom"/><child link="follower"/>
    <origin xyz="0.5 0 0"/><axis xyz="0 1 0"/><mimic joint="bend" multiplier="-0.7" offset="0.2"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
</robot>)";

Scene random_boxes(Rng& rng) {
  const auto point = [&](double most) {
    return Vec3{rng.uniform(-most, most), rng.uniform(-most, most), rng.uniform(-most, most)};
  };
  Obstacle boxes{"boxes", {}};
  for (int i = 0; i < 6; ++i) {
    const Vec3 size = Vec3::Constant(0.05) + point(0.02);
    boxes.shapes.push_back(Box{{rotation_from_rpy(point(3)), point(1)}, size});
  }
  return {"scene", {boxes}};
}

/// As is_path_free() of a motion, by the contacts of each of its states.
bool is_free_state_by_state(const CollisionChecker& checker, const Path& motion,
                            double resolution) {
  const Robot& robot = checker.robot();
  const Configuration delta = robot.difference(motion[0], motion[1]);
  const double steps = std::ceil(robot.distance(motion[0], motion[1]) / resolution);
  for (int step = 0; step <= static_cast<int>(steps); ++step) {
    Configuration q = motion[0];
    for (std::size_t j = 0; j < q.size(); ++j) q[j] += step / steps * delta[j];
    if (!checker.contacts(q).empty()) return false;
  }
  return true;
}

TEST_SUITE("law") {
  TEST_CASE("Leaving out states that are known to be free changes no answer") {
    const Robot robot = require(parse_robot(kLift, "lift.urdf"));
    Rng rng(7);
    int free_count = 0;
    constexpr int kMotions = 1000;
    for (int round = 0; round < kMotions; ++round) {
      const auto checker = require(CollisionChecker::make(robot, random_boxes(rng)));
      const Path motion = {test::random_configuration(robot, rng),
                           test::random_configuration(robot, rng)};
      const double resolution = round % 2 == 0 ? 0.01 : 0.2;
      CAPTURE(round);
      const bool is_free = is_path_free(robot, checker.scene(), motion, resolution);
      REQUIRE(is_free == is_free_state_by_state(checker, motion, resolution));
      free_count += is_free ? 1 : 0;
    }
    CHECK(free_count > kMotions / 10);
    CHECK(free_count < kMotions * 9 / 10);
  }

  TEST_CASE("Leaving out states changes no answer of links checked by exact geometry") {
    const CollisionChecker checker = checker_of_cubes();
    Rng rng(8);
    int free_count = 0;
    constexpr int kMotions = 200;
    for (int round = 0; round < kMotions; ++round) {
      const auto near_contact = [&]() -> Configuration {
        return {rng.uniform(-0.1, 0.02), rng.uniform(-1.0, 1.0)};
      };
      const Path motion = {near_contact(), near_contact()};
      CAPTURE(round);
      const bool is_free = is_path_free(checker.robot(), checker.scene(), motion, 0.02);
      REQUIRE(is_free == is_free_state_by_state(checker, motion, 0.02));
      free_count += is_free ? 1 : 0;
    }
    CHECK(free_count > kMotions / 10);
    CHECK(free_count < kMotions * 9 / 10);
  }

  TEST_CASE("The direction of a path does not matter") {
    const CollisionChecker checker = checker_for({{1.5, 1, 0.3}, {-1, 1.5, 0.4}});
    Rng rng(13);
    int free_count = 0;
    for (int round = 0; round < 100; ++round) {
      CAPTURE(round);
      const Path there = {test::random_configuration(checker.robot(), rng),
                          test::random_configuration(checker.robot(), rng)};
      const Path back(there.rbegin(), there.rend());
      const bool is_free = is_path_free(checker.robot(), checker.scene(), there, 0.005);
      CHECK(is_free == is_path_free(checker.robot(), checker.scene(), back, 0.005));
      free_count += is_free ? 1 : 0;
    }
    CHECK(free_count > 0);
    CHECK(free_count < 100);
  }
}

}  // namespace
}  // namespace mneme
