// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Attached objects and allowed contacts in the kernels' eyes.
#include "mneme/spheres.h"

#include "collision/random_worlds.h"
#include "collision/sweeps.h"
#include "robot/kinematics.h"

#include <doctest/doctest.h>

#include <cmath>

namespace mneme::test {
namespace {

/// Metres: near enough to contact that float and double may disagree.
constexpr double kNearContact = 1e-4;

AttachedObject random_object(const std::string& name, const Robot& robot, Rng& rng) {
  const auto link = rng.index(static_cast<std::uint32_t>(robot.links().size()));
  AttachedObject object{name, robot.links()[link].name, {}};
  const std::uint32_t count = 1 + rng.index(2);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Shape shape = small_shape(rng);
    object.shapes.push_back(transformed(random_pose(rng, 0.3), shape));
  }
  if (rng.index(2) == 0) {
    const auto other = rng.index(static_cast<std::uint32_t>(robot.links().size()));
    object.may_touch.push_back(robot.links()[other].name);
  }
  return object;
}

Robot randomly_carrying(const Robot& robot, Rng& rng) {
  std::vector<AttachedObject> objects = {random_object("cup", robot, rng)};
  if (rng.index(2) == 0) objects.push_back(random_object("lid", robot, rng));
  return require(attach(robot, std::move(objects)));
}

/// Each obstacle may be touched by a third of the links.
void allow_some(Scene& scene, const Robot& robot, Rng& rng) {
  for (Obstacle& obstacle : scene.obstacles) {
    for (const Link& link : robot.links()) {
      if (rng.index(3) == 0) obstacle.may_touch.push_back(link.name);
    }
  }
}

struct Outcome {
  int free = 0, in_contact = 0;
};

/// Every instruction set's answer for every row against the distances of spheres.
void compare_with_clearance(const Robot& robot, const Scene& scene, double margin,
                            const std::vector<float>& rows, Outcome& outcome) {
  for (const Isa isa : available_isas()) {
    const auto checker = require_checker(robot, scene, {.margin = margin, .isa = isa});
    const auto is_valid = check_all(checker, rows);
    for (std::size_t i = 0; i < is_valid.size(); ++i) {
      const auto q = row(rows, i, robot);
      const double gap = clearance(robot, scene, q, margin);
      ++(gap >= 0 ? outcome.free : outcome.in_contact);
      if (std::abs(gap) < kNearContact) continue;
      INFO(to_string(isa) << ", state " << i << ": clearance " << gap);
      REQUIRE((is_valid[i] != 0) == (gap >= 0));
      if (isa != Isa::scalar) continue;
      REQUIRE(checker.contacts(Configuration(q.begin(), q.end())).empty() == (gap >= 0));
    }
  }
}

bool touches(const std::vector<Shape>& first, const Transform& X_first,
             const std::vector<Shape>& second, const Transform& X_second) {
  for (const Shape& a : first) {
    for (const Shape& b : second) {
      if (distance(transformed(X_first, a), transformed(X_second, b)) == 0) return true;
    }
  }
  return false;
}

std::vector<Shape> shapes_of(const Link& link) {
  std::vector<Shape> shapes(link.spheres.begin(), link.spheres.end());
  shapes.insert(shapes.end(), link.capsules.begin(), link.capsules.end());
  return shapes;
}

/// True if an attached object itself, not its spheres, is in forbidden contact.
bool is_object_in_contact(const Robot& robot, const Scene& scene, std::span<const float> q) {
  const std::vector<Transform> poses = robot.link_poses(Configuration(q.begin(), q.end()));
  const std::size_t bare = robot.links().size() - robot.attached().size();
  const auto solid = [&](std::size_t link) {
    return link < bare ? shapes_of(robot.links()[link])
                       : robot.attached()[link - bare].object.shapes;
  };
  const std::vector<bool> is_moving = internal::find_moving_links(robot);
  for (std::size_t i = bare; i < robot.links().size(); ++i) {
    for (const Obstacle& obstacle : scene.obstacles) {
      if (!is_moving[i] || may_touch(robot.links()[i], obstacle)) continue;
      if (touches(solid(i), poses[i], obstacle.shapes, {})) return true;
    }
  }
  return std::ranges::any_of(robot.self_pairs(), [&](const std::pair<int, int>& pair) {
    const auto a = static_cast<std::size_t>(pair.first), b = static_cast<std::size_t>(pair.second);
    return b >= bare && touches(solid(a), poses[a], solid(b), poses[b]);
  });
}

TEST_SUITE("unit") {
  TEST_CASE("obstacles that an unknown link may touch are refused") {
    Scene scene = make_circle_scene("one", {{3, 3, 1}});
    scene.obstacles[0].may_touch = {"link_2", "hand"};
    const Error error = require_error(CollisionChecker::make(planar8(), scene));
    CHECK(error.code == ErrorCode::invalid);
    CHECK(error.message ==
          "obstacle 'circle_1' may be touched by 'hand', but robot 'planar8' has no link and no "
          "attached object of this name");
  }

  TEST_CASE("contact that no motion changes blocks no state, and is told apart") {
    const Robot robot = require_parsed(R"(<robot name="arm">
      <link name="base"><collision><geometry><sphere radius="0.3"/></geometry></collision></link>
      <link name="hand"><collision><origin xyz="1 0 0"/>
        <geometry><sphere radius="0.1"/></geometry></collision></link>
      <joint name="turn" type="revolute"><parent link="base"/><child link="hand"/>
        <axis xyz="0 0 1"/><limit lower="-3" upper="3"/></joint></robot>)");
    const Scene scene{"table",
                      {{"table", {Box{{Eigen::Matrix3d::Identity(), {0, 0, -0.3}}, {2, 2, 0.1}}}}}};
    for (const double margin : {0.0, 0.05}) {
      const auto checker = require_checker(robot, scene, {.margin = margin});
      CHECK(checker.is_valid(Configuration{0}));
      CHECK(checker.is_motion_valid(Configuration{-1}, Configuration{1}, {1, 0.01}));
      CHECK(checker.contacts(Configuration{0}).empty());
      REQUIRE(checker.fixed_contacts().size() == 1);
      CHECK(checker.fixed_contacts()[0].link == "base");
      CHECK(checker.fixed_contacts()[0].other == "table");
    }
    CHECK(!require_checker(robot, scene, {.margin = 0.11}).is_valid(Configuration{0}));
  }

  TEST_CASE("a robot with objects shares the tables of the bare one, and keeps its own") {
    const Robot bare = planar8();
    const auto own = internal::share_checked_robot(bare);
    const Robot robot = require(attach(bare, {{"cup", "link_8", {Sphere{{1, 0, 0}, 0.1}}}}));
    const auto with_cup = require(internal::share_checked_robot(robot));
    CHECK(with_cup == *internal::share_checked_robot(Robot(robot)));
    CHECK(*own == *internal::share_checked_robot(robot.without_attached()));
    CHECK(with_cup->tables.bodies.size() == (*own)->tables.bodies.size() + 1);
    CHECK(with_cup->tables.moving_count == (*own)->tables.moving_count + 1);
    CHECK(with_cup->tables.frames.size() == (*own)->tables.frames.size());
    CHECK(with_cup->tables.links.size() == robot.links().size());
    CHECK(with_cup->tables.limbs.size() == (*own)->tables.limbs.size());
  }

  TEST_CASE("more objects than bodies fit are merged") {
    Robot::Parts parts;
    parts.name = "ring";
    parts.links.push_back({.name = "base"});
    for (int i = 0; i < internal::kMaxBodies; ++i) {
      Joint joint;
      joint.name = "joint" + std::to_string(i);
      joint.type = i == 0 ? JointType::continuous : JointType::fixed;
      joint.axis = Vec3::UnitZ();
      joint.parent_link = i == 0 ? 0 : 1;
      joint.child_link = i + 1;
      parts.joints.push_back(joint);
      parts.links.push_back(
          {.name = "link" + std::to_string(i), .spheres = {{{10.0 + i, 0, 0}, 0.1}}});
    }
    const auto bare = require(make_robot(parts));
    const Robot robot = require(attach(bare, {{"cup", "link0", {Sphere{{0, 5, 0}, 0.1}}}}));
    const auto checked = require(internal::share_checked_robot(robot));
    CHECK(checked->tables.bodies.size() == internal::kMaxBodies);
    const Scene scene{"ball", {{"ball", {Sphere{{0, 5, 0}, 0.1}}}}};
    CHECK(!require_checker(robot, scene).is_valid(Configuration{0}));
    CHECK(require_checker(robot, scene).is_valid(Configuration{1}));
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("hundreds of attached objects share the bodies of their frames") {
    Rng rng(505);
    int free = 0, in_contact = 0;
    for (int i = 0; i < 4; ++i) {
      const Robot bare = random_robot(rng);
      std::vector<AttachedObject> objects;
      for (int k = 0; k < 200; ++k) {
        const auto link = rng.index(static_cast<std::uint32_t>(bare.links().size()));
        AttachedObject object{"o" + std::to_string(k), bare.links()[link].name, {}};
        object.shapes.push_back(Sphere{random_pose(rng, 0.3).translation, 0.002});
        if (k % 3 == 0) object.may_touch.push_back(bare.links()[0].name);
        objects.push_back(std::move(object));
      }
      const Robot robot = require(attach(bare, std::move(objects)));
      const auto checked = require(internal::share_checked_robot(robot));
      const auto& tables = checked->tables;
      CHECK(tables.bodies.size() <= bare.links().size() + tables.frames.size() + 1);
      const CollisionChecker checker =
          require_checker(robot, random_scene(robot, 2, rng, small_shape));
      const auto rows = random_states(robot, 50, rng);
      const auto is_valid = check_all(checker, rows);
      INFO("seed 505, robot " << i);
      for (std::size_t k = 0; k < is_valid.size(); ++k) {
        const auto q = row(rows, k, robot);
        const bool has_contact = !checker.contacts(Configuration{q.begin(), q.end()}).empty();
        CHECK(is_valid[k] != has_contact);
        ++(has_contact ? in_contact : free);
      }
    }
    CHECK(free + in_contact == 200);
    CHECK(in_contact > 10);
  }

  TEST_CASE("allowed contacts are left aside by every instruction set, others are not") {
    Rng rng(501);
    for (const bool carries : {false, true}) {
      Outcome outcome;
      for (int i = 0; i < 40; ++i) {
        const Robot robot = carries ? randomly_carrying(random_robot(rng), rng) : random_robot(rng);
        Scene scene = random_scene(robot, carries ? 3 : 1 + i, rng, small_shape);
        if (!carries || i % 3 == 0) allow_some(scene, robot, rng);
        INFO("seed 501, robot " << i << (carries ? " with objects" : ""));
        compare_with_clearance(robot, scene, i % 2 * 0.05, random_states(robot, 200, rng), outcome);
      }
      CHECK(outcome.free > 1000);
      CHECK(outcome.in_contact > 1000);
    }
  }

  TEST_CASE("what attached objects sweep is free only if they touch nothing on the way") {
    Rng rng(504);
    SweepTally tally;
    for (int i = 0; i < 30; ++i) {
      const Robot robot = randomly_carrying(random_robot(rng), rng);
      Scene scene = random_scene(robot, 2, rng, small_shape);
      if (i % 3 == 0) allow_some(scene, robot, rng);
      const CollisionChecker checker = require_checker(robot, scene);
      INFO("seed 504, robot " << i);
      const auto rows = random_states(robot, 20, rng, 0.3);
      for (std::size_t k = 1; k < 20; ++k) {
        const auto a = row(rows, k - 1, robot), b = row(rows, k, robot);
        tally.compare(checker, {a.begin(), a.end()}, {b.begin(), b.end()}, 50);
      }
    }
    CHECK(tally.free > 30);
    CHECK(tally.blocked > 30);
  }

  TEST_CASE("no state is free where an attached box, cylinder, sphere or capsule itself touches") {
    Rng rng(503);
    int touching = 0, free_count = 0, only_spheres_touch = 0;
    for (int i = 0; i < 80; ++i) {
      const Robot robot = randomly_carrying(random_robot(rng), rng);
      Scene scene = random_scene(robot, 2, rng, small_shape);
      const CollisionChecker by_spheres = require_checker(robot, scene);
      if (i % 2 == 0) check_obstacles_exactly(scene, robot, rng);
      if (i % 2 == 0) check_links_exactly(scene, robot, rng);
      INFO("seed 503, robot " << i);
      const auto rows = random_states(robot, 100, rng);
      const auto is_valid = check_all(require_checker(robot, scene), rows);
      const auto are_spheres_free = check_all(by_spheres, rows);
      for (std::size_t k = 0; k < is_valid.size(); ++k) {
        free_count += is_valid[k];
        only_spheres_touch += is_valid[k] - are_spheres_free[k];
        REQUIRE(is_valid[k] >= are_spheres_free[k]);
        if (!is_object_in_contact(robot, scene, row(rows, k, robot))) continue;
        ++touching;
        REQUIRE(is_valid[k] == 0);
      }
    }
    CHECK(touching > 500);
    CHECK(free_count > 500);
    CHECK(only_spheres_touch > 50);
  }
}

}  // namespace
}  // namespace mneme::test
