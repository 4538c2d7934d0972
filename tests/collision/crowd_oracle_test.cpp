// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels in front of points, meshes and octrees against a look at every part.
#include "collision/random_worlds.h"
#include "geometry/random_crowds.h"

#include <array>

namespace mneme::test {
namespace {

/// What single precision may make of a distance.
constexpr double kTolerance = 1e-4;

constexpr std::array kMakers = {random_cloud, random_mesh, random_octree};

/// Least gap of a shape of the robot to a part of an obstacle, part by part.
double gap_by_parts(const Robot& robot, const Scene& scene, std::span<const double> q) {
  const std::vector<Transform> poses = robot.link_poses(q);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (const Capsule& own : capsules_of(robot.links()[i], poses[i])) {
      for (const Obstacle& obstacle : scene.obstacles) {
        for (const Shape& shape : obstacle.shapes) {
          const double distance = std::visit(DistanceByParts{own.a, own.b}, shape);
          least = std::min(least, distance - own.radius);
        }
      }
    }
  }
  return least;
}

struct Counts {
  int free = 0, touching = 0;
};

/// Compares all instruction sets with the look at every part, leaving contacts of links with links
/// aside.
void compare_with_parts(const Robot& robot, const Scene& scene, double margin, int states, Rng& rng,
                        Counts& counts) {
  const std::vector<float> rows = random_states(robot, states, rng);
  const auto alone = check_all(require_checker(robot, {}), rows);
  for (const Isa isa : available_isas()) {
    const auto checker = require_checker(robot, scene, {.margin = margin, .isa = isa});
    const auto is_valid = check_all(checker, rows);
    for (std::size_t i = 0; i < is_valid.size(); ++i) {
      if (alone[i] == 0) continue;
      const auto q = row(rows, i, robot);
      const double gap = gap_by_parts(robot, scene, Configuration(q.begin(), q.end())) - margin;
      ++(gap < 0 ? counts.touching : counts.free);
      INFO(to_string(isa) << ", state " << i << ": gap " << gap);
      if (gap < -kTolerance) REQUIRE(is_valid[i] == 0);
      if (gap > kTolerance) REQUIRE(is_valid[i] != 0);
    }
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("no state is called free that touches a part, and none touching that does not") {
    Rng rng(301);
    for (const auto make : kMakers) {
      Counts counts;
      for (int i = 0; i < 6; ++i) {
        const Robot robot = random_robot(rng);
        const Scene scene = random_scene(robot, 4, rng, make);
        INFO("seed 301, robot " << i);
        compare_with_parts(robot, scene, i % 2 == 0 ? 0.0 : 0.02, 150, rng, counts);
      }
      CHECK(counts.free > 50);
      CHECK(counts.touching > 50);
    }
  }

  TEST_CASE("exact contacts with crowds are those of a look at every part") {
    Rng rng(302);
    int touching = 0;
    for (int i = 0; i < 9; ++i) {
      const Robot robot = random_robot(rng);
      const Scene scene = random_scene(robot, 2, rng, kMakers[static_cast<std::size_t>(i % 3)]);
      const CollisionChecker checker = require_checker(robot, scene);
      for (int k = 0; k < 30; ++k) {
        const Configuration q = random_configuration(robot, rng);
        const auto contacts = checker.contacts(q);
        const bool touches =
            std::ranges::any_of(contacts, [](const Contact& c) { return !c.is_self; });
        INFO("seed 302, robot " << i);
        CHECK(touches == (gap_by_parts(robot, scene, q) < 0));
        touching += touches ? 1 : 0;
      }
    }
    CHECK(touching > 5);
  }

  TEST_CASE("motions stop where a state of theirs touches a crowd") {
    Rng rng(303);
    int blocked = 0, open = 0;
    for (int i = 0; i < 30; ++i) {
      const Robot robot = random_robot(rng);
      const Scene scene = random_scene(robot, 2, rng, kMakers[static_cast<std::size_t>(i % 3)]);
      const CollisionChecker checker = require_checker(robot, scene);
      for (int k = 0; k < 20; ++k) {
        const Configuration from = random_configuration(robot, rng);
        Configuration to = from;
        for (double& value : to) value += rng.uniform(-0.1, 0.1);
        for (int j = 0; j < robot.joint_count(); ++j) {
          const Joint& joint = robot.group_joint(j);
          auto& value = to[static_cast<std::size_t>(j)];
          value = std::clamp(value, joint.lower, joint.upper);
        }
        if (!checker.is_valid(from)) continue;
        const bool is_valid = checker.is_motion_valid(from, to);
        ++(is_valid ? open : blocked);
        if (is_valid) CHECK(checker.is_valid(to));
      }
    }
    CHECK(blocked > 10);
    CHECK(open > 50);
  }
}

}  // namespace
}  // namespace mneme::test
