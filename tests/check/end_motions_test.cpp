// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/check.h"
#include "mneme/spheres.h"

#include "planning/small_worlds.h"
#include "report/report_support.h"

#include <limits>

namespace mneme::test {
namespace {

constexpr double kFine = 1e-3;  // radians

/// The unit arm holds a ball at its tip; a post stands beside it.
struct Beside {
  Robot robot;
  Scene scene;

  /// At zero the ball overlaps the post by `depth` metres. Without a ball the last link does.
  explicit Beside(double depth, bool has_ball = true) : robot(unit_arm(3)) {
    const double radius = has_ball ? 0.05 : robot.links().back().capsules.front().radius;
    if (has_ball) {
      robot =
          attach(robot, {{"ball", robot.links().back().name, {Sphere{{1, 0, 0}, 0.05}}}}).value();
    }
    scene = make_circle_scene("scene", {{has_ball ? 3.0 : 2.5, 0.3 + radius - depth, 0.3}});
  }
  [[nodiscard]] bool is_free(const std::vector<Configuration>& path,
                             const EndTolerances& tolerances = {}) const {
    return is_path_free(robot, scene, path, kFine, tolerances);
  }
};

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a start may be a little beyond limits, and nothing else may") {
    const Robot robot = thick_arm({1, 1, 0.5});
    const double most = robot.group_joint(2).upper;
    const Configuration inside = {0, 0.5, most}, home = {0, 0.5, 0.5};
    const auto at = [&](double excess) { return Configuration{0, 0.5, most + excess}; };
    const auto is_free = [&](const Path& path, const EndTolerances& tolerances = {}) {
      return is_path_free(robot, {}, path, kFine, tolerances);
    };
    CHECK(is_free({at(0.04), inside, home}));
    CHECK_FALSE(is_free({at(0.04), inside, home}, {0, 0, 0, 0}));
    CHECK_FALSE(is_free({at(0.06), inside, home}));
    CHECK_FALSE(is_free({at(0.04), at(0.02), inside}));
    CHECK_FALSE(is_free({home, inside, at(0.04)}));
    CHECK_FALSE(is_free({home, at(0.04), home}));
    CHECK_FALSE(is_free({at(0.04)}));
    CHECK_FALSE(is_free({at(std::numeric_limits<double>::quiet_NaN()), inside}));
    CHECK_FALSE(is_free({{0, most + 0.04}, inside}));
  }

  TEST_CASE("contact of less than a millimetre may be left at the start, and never entered") {
    const Beside shallow(0.0005, false), deep(0.002, false);
    const Configuration touching = {0, 0, 0}, away = {-0.2, 0, 0}, deeper = {0.0001, 0, 0};
    CHECK(shallow.is_free({touching, away}));
    CHECK_FALSE(is_path_free(shallow.robot, shallow.scene, {touching, away}, kFine));
    CHECK_FALSE(shallow.is_free({touching, away}, {0.05, 0.005, 0, 0.005}));
    CHECK_FALSE(shallow.is_free({away, touching}));
    CHECK_FALSE(shallow.is_free({touching, deeper, away}));
    CHECK_FALSE(shallow.is_free({touching}));
    CHECK_FALSE(deep.is_free({touching, away}));
  }

  TEST_CASE("a thin link deep in an obstacle is not barely in contact") {
    const Robot robot = planar8();
    const Scene scene = make_circle_scene("scene", {{5, 0, 1}});
    const Configuration across(8, 0.0);
    Configuration away = across;
    away[0] = 1;
    CHECK(is_path_free(robot, scene, {away}, kFine, EndTolerances()));
    CHECK_FALSE(is_path_free(robot, scene, {across, away}, kFine, EndTolerances()));
  }

  TEST_CASE("a held object may leave contact and enter it within the stretch") {
    const Beside world(0.002);
    const Configuration touching = {0, 0, 0}, away = {-0.05, 0, 0}, deeper = {0.0001, 0, 0};
    CHECK(world.is_free({touching, away}));
    CHECK(world.is_free({away, touching}));
    CHECK(world.is_free({touching, away, {-0.05, 0.01, 0}, away, touching}));
    CHECK_FALSE(world.is_free({touching, away}, {0.05, 0.005, 0.001, 0}));
    CHECK_FALSE(world.is_free({touching, away}, {0.05, 0.005, 0.001, 0.0015}));
    CHECK_FALSE(world.is_free({touching, deeper, away}));
    CHECK_FALSE(world.is_free({away, touching, away}));
    CHECK_FALSE(world.is_free({away, deeper, touching}));
    // Contact that ends after more than 5 mm.
    CHECK_FALSE(Beside(0.007).is_free({touching, away}));
  }

  TEST_CASE("a pair that may touch at the ends leaves and enters contact within its own stretch") {
    const Configuration touching = {0, 0, 0}, away = {-0.05, 0, 0}, deeper = {0.0001, 0, 0};
    for (const bool has_ball : {false, true}) {
      CAPTURE(has_ball);
      Beside world(0.007, has_ball);
      const std::string name = world.robot.links().back().name;
      CHECK_FALSE(world.is_free({away, touching}));
      world.scene.end_contacts = {{name, "circle_1", 0.02}};
      CHECK(world.is_free({touching, away}));
      CHECK(world.is_free({away, touching}));
      CHECK(world.is_free({touching, away, {-0.05, 0.01, 0}, away, touching}, {0, 0, 0, 0}));
      CHECK_FALSE(world.is_free({touching, deeper, away}));
      CHECK_FALSE(world.is_free({away, touching, away}));
      world.scene.end_contacts = {{name, "circle_1", 0.006}};
      CHECK_FALSE(world.is_free({touching, away}));
      world.scene.end_contacts = {{name, "another", 0.02}};
      CHECK_FALSE(world.is_free({touching, away}));
    }
  }

  TEST_CASE("two links that may touch at the ends are named in any order") {
    // The third link is folded over the begin of the first.
    const Robot robot = thick_arm({1, 1, 1});
    const Configuration touching = {0, 2.9, 1.7}, away = {0, 2.9, 1.4};
    Scene scene;
    const std::string first = robot.links()[1].name, last = robot.links().back().name;
    REQUIRE_FALSE(is_path_free(robot, scene, {touching}, kFine));
    REQUIRE(is_path_free(robot, scene, {away}, kFine));
    for (const bool is_swapped : {false, true}) {
      scene.end_contacts = {{is_swapped ? last : first, is_swapped ? first : last, 1.0}};
      CHECK(is_path_free(robot, scene, {touching, away}, kFine, EndTolerances()));
    }
    scene.end_contacts = {{robot.links()[2].name, last, 1.0}};
    CHECK_FALSE(is_path_free(robot, scene, {touching, away}, kFine, EndTolerances()));
  }

  TEST_CASE("what else is in the way of a held object counts along its first motion") {
    Beside world(0.002);
    world.scene.obstacles.push_back({"peg", {Sphere{{3, -0.1, 0}, 0.03}}});
    CHECK(world.is_free({{0, 0, 0}, {-0.005, 0, 0}}));
    CHECK_FALSE(world.is_free({{0, 0, 0}, {-0.05, 0, 0}}));
  }

  TEST_CASE("the tilt of a start beyond its cone may only decrease") {
    const Robot robot = unit_arm(3);
    const OrientationConstraint constraint{"link_3", Vec3::UnitX(), Vec3::UnitX(), 0.3};
    const auto keeps = [&](const std::vector<Configuration>& path, double angle = 0.05) {
      return keeps_cone(robot, constraint, path, kFine, {angle, 0, 0, 0});
    };
    CHECK(keeps({{0.2, 0, 0}, {0, 0, 0}}));
    CHECK(keeps({{0.33, 0, 0}, {0.29, 0, 0}, {0, 0, 0}}));
    CHECK_FALSE(keeps({{0.33, 0, 0}, {0.29, 0, 0}}, 0));
    CHECK_FALSE(keeps({{0.36, 0, 0}, {0.29, 0, 0}}));
    CHECK_FALSE(keeps({{0.33, 0, 0}, {0.34, 0, 0}, {0, 0, 0}}));
    CHECK_FALSE(keeps({{0, 0, 0}, {0.33, 0, 0}}));
    CHECK_FALSE(keeps({{0.33, 0, 0}}));
  }
}

}  // namespace mneme::test
