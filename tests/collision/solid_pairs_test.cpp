// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Pairs that are checked by what covers cover, against FCL.
#include "mneme/collision.h"

#include "collision/random_worlds.h"
#include "geometry/box_surface.h"
#include "geometry/fcl_shapes.h"

#include <memory>
#include <string>
#include <vector>

namespace mneme::test {
namespace {

constexpr double kBeyond = 1e9;

/// A robot whose links are boxes in a cover of one sphere, which sticks out by decimetres.
struct CoveredRobot {
  Robot robot;
  std::vector<Box> boxes;
};

Link covered_link(const std::string& name, const Box& box, double excess) {
  Link link;
  link.name = name;
  link.spheres = {{box.pose.translation, box.half_extents.norm()}};
  link.cover = Cover{{{}, std::make_shared<Parts<Triangle>>(surface_of(box)), 0}, 1, excess};
  return link;
}

/// Its links may touch each other, or only those next to each other and a few more.
CoveredRobot random_covered_robot(Rng& rng, bool checks_links = false) {
  Robot::Parts parts;
  parts.name = "boxes";
  std::vector<Box> boxes;
  std::vector<std::string> moving;
  const int count = 3 + static_cast<int>(rng.index(3)) + (checks_links ? 1 : 0);
  for (int i = 0; i <= count; ++i) {
    const Vec3 half = random_vector(rng, 0.15).cwiseAbs() + Vec3::Constant(0.01);
    boxes.push_back({random_pose(rng, 0.1), half});
    parts.links.push_back(covered_link("link" + std::to_string(i), boxes.back(), half.norm()));
    if (i == 0) continue;
    parts.joints.push_back(random_joint(i, rng));
    if (parts.joints.back().type == JointType::fixed)
      parts.joints.back().type = JointType::revolute;
    if (!follows_another(parts, moving, rng)) moving.push_back(parts.joints.back().name);
  }
  parts.allowed_pairs.emplace();
  for (const Link& a : parts.links) {
    for (const Link& b : parts.links) {
      const bool is_allowed =
          !checks_links || a.name.back() + 1 == b.name.back() || rng.index(4) == 0;
      if (a.name < b.name && is_allowed) parts.allowed_pairs->emplace_back(a.name, b.name);
    }
  }
  const auto robot = make_robot(parts);
  REQUIRE_MESSAGE(robot.has_value(), (robot ? "" : robot.error().message));
  return {*robot, std::move(boxes)};
}

Scene scene_by_solid(const Robot& robot, Rng& rng) {
  Scene scene;
  for (int i = 0; i < 4; ++i) {
    const Transform pose = random_pose(rng, 0.6);
    const Vec3 sizes = random_vector(rng, 0.12).cwiseAbs() + Vec3::Constant(0.02);
    const std::array<Shape, 4> shapes = {
        Sphere{pose.translation, sizes[0]}, Box{pose, sizes}, Cylinder{pose, sizes[0], sizes[1]},
        Capsule{pose.translation, pose.translation + sizes, sizes[2]}};
    Obstacle& obstacle = scene.obstacles.emplace_back();
    obstacle.name = std::to_string(i);
    obstacle.shapes = {shapes[rng.index(4)]};
    for (const Link& link : robot.links()) {
      if (rng.index(2) == 0) obstacle.by_solid.push_back(link.name);
    }
  }
  return scene;
}

/// From a box, by code that has nothing to do with triangles.
double distance_from(const Box& box, const Shape& shape) {
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    return distance(sphere->center, box) - sphere->radius;
  }
  if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    return distance_to_segment(capsule->a, capsule->b, box) - capsule->radius;
  }
  return fcl_distance(box, shape);
}

/// Metres between links that move and obstacles, at most 0 in contact: of pairs that are checked by
/// solid, and of covers.
struct Gaps {
  double solids = kBeyond, covers = kBeyond, ignored_covers = kBeyond;
  [[nodiscard]] double least() const { return std::min(solids, covers); }
};

Gaps gaps_at(const CoveredRobot& covered, const Scene& scene, const Configuration& q) {
  const Robot& robot = covered.robot;
  const std::vector<Transform> poses = robot.link_poses(q);
  const std::vector<bool> is_moving = internal::find_moving_links(robot);
  Gaps gaps;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!is_moving[i]) continue;
    const Link& link = robot.links()[i];
    const auto known = std::stoul(link.name.substr(4));
    const Shape box = transformed(poses[i], covered.boxes[known]);
    const Sphere& cover = link.spheres[0];
    for (const Obstacle& obstacle : scene.obstacles) {
      const double from_cover =
          distance(poses[i] * cover.center, obstacle.shapes[0]) - cover.radius;
      const bool is_by_solid = std::ranges::count(obstacle.by_solid, link.name) > 0;
      double& least = is_by_solid ? gaps.ignored_covers : gaps.covers;
      least = std::min(least, from_cover);
      if (!is_by_solid) continue;
      gaps.solids = std::min(gaps.solids, distance_from(std::get<Box>(box), obstacle.shapes[0]));
    }
  }
  return gaps;
}

/// Half of the pairs that the robot checks; names stand in either order.
Scene links_by_solid(const Robot& robot, Rng& rng) {
  Scene scene;
  for (const auto& [a, b] : robot.self_pairs()) {
    const auto name = [&](int link) { return robot.links()[static_cast<std::size_t>(link)].name; };
    if (rng.index(2) == 0)
      scene.by_solid.emplace_back(name(a), name(b));
    else if (rng.index(2) == 0)
      scene.by_solid.emplace_back(name(b), name(a));
  }
  return scene;
}

/// Of links from each other; solids in FCL.
Gaps link_gaps_at(const CoveredRobot& covered, const Scene& scene, const Configuration& q) {
  const Robot& robot = covered.robot;
  const std::vector<Transform> poses = robot.link_poses(q);
  Gaps gaps;
  for (const auto& [a, b] : robot.self_pairs()) {
    const auto i = static_cast<std::size_t>(a), k = static_cast<std::size_t>(b);
    const Link &one = robot.links()[i], &two = robot.links()[k];
    const Sphere &first = one.spheres[0], &second = two.spheres[0];
    const double from_cover =
        (poses[i] * first.center - poses[k] * second.center).norm() - first.radius - second.radius;
    const bool is_by_solid =
        std::ranges::count(scene.by_solid, std::pair(one.name, two.name)) > 0 ||
        std::ranges::count(scene.by_solid, std::pair(two.name, one.name)) > 0;
    double& least = is_by_solid ? gaps.ignored_covers : gaps.covers;
    least = std::min(least, from_cover);
    if (!is_by_solid) continue;
    const auto box_of = [&](const Link& link) -> const Box& {
      return covered.boxes[std::stoul(link.name.substr(4))];
    };
    gaps.solids = std::min(gaps.solids, fcl_distance(transformed(poses[i], box_of(one)),
                                                     transformed(poses[k], box_of(two))));
  }
  return gaps;
}

Configuration configuration_of(std::span<const float> q) { return {q.begin(), q.end()}; }

TEST_SUITE("oracle") {
  TEST_CASE("a state is free if solids are, where they are checked, and covers elsewhere") {
    constexpr double kNear = 1e-4;
    Rng rng(91);
    int free = 0, touching = 0, only_covers_touch = 0;
    for (int world = 0; world < 25; ++world) {
      const CoveredRobot covered = random_covered_robot(rng);
      const Scene scene = scene_by_solid(covered.robot, rng);
      const double margin = world % 3 == 0 ? 0.02 : 0;
      const std::vector<float> rows = random_states(covered.robot, 60, rng);
      for (const Isa isa : available_isas()) {
        const auto checker = require_checker(covered.robot, scene, {.margin = margin, .isa = isa});
        const std::vector<std::uint8_t> is_valid = check_all(checker, rows);
        for (std::size_t i = 0; i < is_valid.size(); ++i) {
          const Configuration q = configuration_of(row(rows, i, covered.robot));
          const Gaps gaps = gaps_at(covered, scene, q);
          if (std::abs(gaps.least() - margin) < kNear) continue;
          INFO("seed 91, world " << world << ", state " << i << ", " << gaps.least());
          REQUIRE((is_valid[i] != 0) == (gaps.least() > margin));
          if (isa != Isa::scalar) continue;
          CHECK(checker.contacts(q).empty() == (gaps.least() > margin));
          if (margin == 0) CHECK(is_path_free(covered.robot, scene, {q}, 1) == (is_valid[i] != 0));
          ++(is_valid[i] != 0 ? free : touching);
          only_covers_touch += is_valid[i] != 0 && gaps.ignored_covers < margin ? 1 : 0;
        }
      }
    }
    CHECK(free > 200);
    CHECK(touching > 200);
    CHECK(only_covers_touch > 60);
  }

  TEST_CASE("links are free of each other if solids are, where they are checked, or covers") {
    constexpr double kNear = 1e-4;
    Rng rng(93);
    int free = 0, touching = 0, only_covers_touch = 0;
    for (int world = 0; world < 60; ++world) {
      const CoveredRobot covered = random_covered_robot(rng, true);
      const Scene scene = links_by_solid(covered.robot, rng);
      // Margins are for obstacles.
      const double margin = world % 3 == 0 ? 0.05 : 0;
      const std::vector<float> rows = random_states(covered.robot, 60, rng);
      for (const Isa isa : available_isas()) {
        const auto checker = require_checker(covered.robot, scene, {.margin = margin, .isa = isa});
        const std::vector<std::uint8_t> is_valid = check_all(checker, rows);
        for (std::size_t i = 0; i < is_valid.size(); ++i) {
          const Configuration q = configuration_of(row(rows, i, covered.robot));
          const Gaps gaps = link_gaps_at(covered, scene, q);
          if (gaps.least() > 0 ? gaps.least() < kNear : gaps.least() > -kNear && gaps.solids > 0) {
            continue;
          }
          INFO("seed 93, world " << world << ", state " << i << ", " << gaps.least());
          REQUIRE((is_valid[i] != 0) == (gaps.least() > 0));
          if (isa != Isa::scalar) continue;
          CHECK(checker.contacts(q).empty() == (gaps.least() > 0));
          CHECK(is_path_free(covered.robot, scene, {q}, 1) == (is_valid[i] != 0));
          ++(is_valid[i] != 0 ? free : touching);
          only_covers_touch += is_valid[i] != 0 && gaps.ignored_covers < 0 ? 1 : 0;
        }
      }
    }
    CHECK(free > 200);
    CHECK(touching > 200);
    CHECK(only_covers_touch > 100);
  }

  TEST_CASE("on a free motion no solids of links touch, between states neither") {
    Rng rng(94);
    int free = 0, free_by_solids = 0, blocked_by_solids = 0;
    for (int world = 0; world < 60; ++world) {
      const CoveredRobot covered = random_covered_robot(rng, true);
      Scene scene = links_by_solid(covered.robot, rng);
      const auto checker = require_checker(covered.robot, scene);
      const auto by_covers = require_checker(covered.robot, Scene{});
      const std::vector<float> rows = random_states(covered.robot, 12, rng);
      CheckCounters counters;
      for (std::size_t i = 0; i + 1 < 12; ++i) {
        const auto from = row(rows, i, covered.robot), to = row(rows, i + 1, covered.robot);
        const bool is_chain = checker.is_chain_valid({from.data(), 2 * from.size()}, counters);
        const bool is_motion = checker.is_motion_valid(from, to, counters);
        const bool is_sweep = checker.is_sweep_valid(from, to, counters, {.margin = 1e-4});
        if (by_covers.is_motion_valid(from, to, counters)) REQUIRE(is_motion);
        double least = kBeyond;
        const Configuration a = configuration_of(from);
        const Configuration way = covered.robot.difference(a, configuration_of(to));
        for (int k = 1; k <= 300; ++k) {
          Configuration q = a;
          for (std::size_t j = 0; j < q.size(); ++j) q[j] += way[j] * k / 300;
          least = std::min(least, link_gaps_at(covered, scene, q).solids);
        }
        INFO("seed 94, world " << world << ", motion " << i);
        if (is_chain || is_motion || is_sweep) REQUIRE(least > 0);
        free += is_sweep ? 1 : 0;
        free_by_solids += is_sweep && !by_covers.is_motion_valid(from, to, counters) ? 1 : 0;
        blocked_by_solids += least == 0 ? 1 : 0;
      }
    }
    CHECK(free > 40);
    CHECK(free_by_solids > 20);
    CHECK(blocked_by_solids > 40);
  }

  TEST_CASE("on a free motion no solid touches, between states neither") {
    Rng rng(92);
    int free = 0, blocked_by_solids = 0;
    for (int world = 0; world < 40; ++world) {
      const CoveredRobot covered = random_covered_robot(rng);
      const Scene scene = scene_by_solid(covered.robot, rng);
      const auto checker = require_checker(covered.robot, scene);
      Scene without = scene;
      for (Obstacle& obstacle : without.obstacles) obstacle.may_touch = obstacle.by_solid;
      const auto ignorant = require_checker(covered.robot, without);
      const std::vector<float> rows = random_states(covered.robot, 12, rng);
      CheckCounters counters;
      for (std::size_t i = 0; i + 1 < 12; ++i) {
        const auto from = row(rows, i, covered.robot), to = row(rows, i + 1, covered.robot);
        const std::size_t joints = from.size();
        const bool is_chain = checker.is_chain_valid({from.data(), 2 * joints}, counters);
        const bool is_motion = checker.is_motion_valid(from, to, counters);
        const bool is_sweep = checker.is_sweep_valid(from, to, counters, {.margin = 1e-4});
        if (!is_motion) blocked_by_solids += ignorant.is_motion_valid(from, to, counters) ? 1 : 0;
        if (!is_chain && !is_motion && !is_sweep) continue;
        ++free;
        const Configuration a = configuration_of(from);
        const Configuration way = covered.robot.difference(a, configuration_of(to));
        for (int k = 0; k <= 300; ++k) {
          Configuration q = a;
          for (std::size_t j = 0; j < q.size(); ++j) q[j] += way[j] * k / 300;
          INFO("seed 92, world " << world << ", motion " << i << ", state " << k);
          REQUIRE(gaps_at(covered, scene, q).solids > 0);
        }
      }
    }
    CHECK(free > 20);
    CHECK(blocked_by_solids > 20);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("an obstacle that is checked by the solid of an unknown link is refused") {
    Scene scene = make_circle_scene("one", {{3, 3, 1}});
    scene.obstacles[0].by_solid = {"hand"};
    const auto checker = CollisionChecker::make(planar8(), scene);
    REQUIRE(!checker.has_value());
    CHECK(checker.error().message ==
          "obstacle 'circle_1' is checked by the solid of 'hand', but robot 'planar8' has no link "
          "and no attached object of this name");
  }

  TEST_CASE("a scene with a pair of an unknown link is refused") {
    Scene scene{"two", {}};
    scene.by_solid = {{planar8().links()[0].name, "hand"}};
    const auto checker = CollisionChecker::make(planar8(), scene);
    REQUIRE(!checker.has_value());
    CHECK(checker.error().message ==
          "scene 'two' has a pair checked by solid of 'hand', but robot 'planar8' has no link and "
          "no attached object of this name");
  }

  TEST_CASE("a capsule that lies wholly inside what another link covers touches it") {
    const Box box{{}, {0.3, 0.3, 0.3}};
    for (const double out : {0.0, 0.55}) {
      Robot::Parts parts;
      parts.name = "held";
      Link pin;
      pin.name = "pin";
      pin.capsules = {{{out, 0, -0.1}, {out, 0, 0.1}, 0.02}};
      parts.links = {covered_link("case", box, 0.3), pin};
      Joint& joint = parts.joints.emplace_back();
      joint.name = "slide";
      joint.type = JointType::prismatic;
      joint.parent_link = 0;
      joint.child_link = 1;
      joint.lower = -0.1;
      joint.upper = 0.1;
      parts.allowed_pairs.emplace();
      const auto robot = make_robot(parts);
      REQUIRE_MESSAGE(robot.has_value(), (robot ? "" : robot.error().message));
      Scene scene;
      scene.by_solid = {{"case", "pin"}};
      const CollisionChecker checker = require_checker(*robot, scene);
      const std::vector<double> q = {0.0};
      CHECK(checker.is_valid(q) == (out > 0));
      CHECK(checker.contacts(q).empty() == (out > 0));
    }
  }

  TEST_CASE("pairs of links without a cover are checked as ever") {
    Rng rng(95);
    const Robot robot = planar8();
    Scene scene;
    for (const auto& [a, b] : robot.self_pairs()) {
      scene.by_solid.emplace_back(robot.links()[static_cast<std::size_t>(a)].name,
                                  robot.links()[static_cast<std::size_t>(b)].name);
    }
    const std::vector<float> rows = random_states(robot, 200, rng);
    CHECK(check_all(require_checker(robot, scene), rows) ==
          check_all(require_checker(robot, Scene{}), rows));
  }

  TEST_CASE("links without a cover are checked as ever") {
    Scene scene = make_circle_scene("one", {{5, 0, 1}});
    const Configuration straight(8, 0.0);
    const Robot robot = planar8();
    CHECK_FALSE(require_checker(robot, scene).is_valid(straight));
    for (const Link& link : robot.links()) scene.obstacles[0].by_solid.push_back(link.name);
    CHECK_FALSE(require_checker(robot, scene).is_valid(straight));
  }
}

}  // namespace
}  // namespace mneme::test
