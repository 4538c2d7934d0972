// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels in front of points, meshes and octrees against a look at every part.
#include "collision/random_worlds.h"
#include "collision/sweeps.h"
#include "geometry/random_crowds.h"

#include <array>

namespace mneme::test {
namespace {

/// What single precision may make of a distance.
constexpr double kTolerance = 1e-4;

constexpr std::array kMakers = {random_cloud, random_mesh, random_octree};

/// Least gap of a shape of the robot that a joint moves to a part of an obstacle, part by part.
double gap_by_parts(const Robot& robot, const Scene& scene, std::span<const double> q) {
  const std::vector<Transform> poses = robot.link_poses(q);
  const std::vector<bool> is_moving = internal::find_moving_links(robot);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!is_moving[i]) continue;
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

/// Moves the parts in their frame, and the frame back.
struct SetAside {
  Vec3 away;

  [[nodiscard]] CloudPoint moved(CloudPoint p) const {
    for (int axis = 0; axis < 3; ++axis) {
      p[static_cast<std::size_t>(axis)] += static_cast<float>(away[axis]);
    }
    return p;
  }
  [[nodiscard]] Triangle moved(const Triangle& t) const {
    return {t.a + away, t.b + away, t.c + away};
  }
  [[nodiscard]] Cube moved(const Cube& c) const { return {c.center + away, c.half_extent}; }

  template <class Part>
  Shape operator()(Crowd<Part> crowd) const {
    std::vector<Part> parts;
    for (const Part& part : crowd.parts->list()) parts.push_back(moved(part));
    crowd = crowd_of(std::move(parts), crowd.radius);
    crowd.pose.translation = -away;
    return crowd;
  }
  template <class Solid>
  Shape operator()(const Solid& solid) const {
    return solid;
  }
};

struct Counts {
  int free = 0, touching = 0;
};

/// Compares all instruction sets with the look at every part, leaving contacts of links with links
/// aside. Counts states.
void compare_with_parts(const Robot& robot, const Scene& scene, double margin, int states, Rng& rng,
                        Counts& counts) {
  const std::vector<float> rows = random_states(robot, states, rng);
  const auto alone = check_all(require_checker(robot, {}), rows);
  std::vector<double> gaps(alone.size());
  for (std::size_t i = 0; i < alone.size(); ++i) {
    if (alone[i] == 0) continue;
    const auto q = row(rows, i, robot);
    gaps[i] = gap_by_parts(robot, scene, Configuration(q.begin(), q.end())) - margin;
    ++(gaps[i] < 0 ? counts.touching : counts.free);
  }
  for (const Isa isa : available_isas()) {
    const auto is_valid =
        check_all(require_checker(robot, scene, {.margin = margin, .isa = isa}), rows);
    for (std::size_t i = 0; i < is_valid.size(); ++i) {
      if (alone[i] == 0 || std::abs(gaps[i]) <= kTolerance) continue;
      INFO(to_string(isa) << ", state " << i << ": gap " << gaps[i]);
      REQUIRE((is_valid[i] != 0) == (gaps[i] > 0));
    }
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("no state is called free that touches a part, and none touching that does not") {
    Rng rng(301);
    for (const auto make : kMakers) {
      Counts counts;
      for (int i = 0; i < rounds(6); ++i) {
        const Robot robot = random_robot(rng);
        const Scene scene = random_scene(robot, 4, rng, make);
        INFO("seed 301, robot " << i);
        compare_with_parts(robot, scene, i % 2 == 0 ? 0.0 : 0.02, 150, rng, counts);
      }
      MESSAGE(counts.free << " free states and " << counts.touching << " that touch");
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

  TEST_CASE("parts that lie far from their own origin are checked as if they did not") {
    Rng rng(304);
    for (const auto make : kMakers) {
      const bool is_cloud = make == random_cloud;
      const Vec3 away = is_cloud ? Vec3(3000, -4000, 500) : Vec3(5e5, -4.6e6, 100);
      const auto make_far = [&](Rng& r) { return std::visit(SetAside{away}, make(r)); };
      Counts counts;
      for (int i = 0; i < 4; ++i) {
        const Robot robot = random_robot(rng);
        const Scene scene = random_scene(robot, 4, rng, make_far);
        INFO("seed 304, robot " << i);
        compare_with_parts(robot, scene, 0, 150, rng, counts);
      }
      CHECK(counts.free > 50);
      CHECK(counts.touching > 50);
    }
  }

  TEST_CASE("what is swept in front of a crowd is free only if it touches nothing on the way") {
    Rng rng(303);
    for (const auto make : kMakers) {
      SweepTally tally;
      for (int i = 0; i < 12; ++i) {
        const Robot robot = random_robot(rng);
        const Scene scene = random_scene(robot, 2, rng, make);
        const double margin = i % 2 == 0 ? 0.0 : 0.02;
        const auto rows = random_states(robot, 12, rng, 0.3);
        INFO("seed 303, robot " << i << ", margin " << margin);
        for (std::size_t k = 1; k < 12; ++k) {
          const auto a = row(rows, k - 1, robot), b = row(rows, k, robot);
          const Configuration from(a.begin(), a.end()), to(b.begin(), b.end());
          const double deepest =
              deepest_contact(require_checker(robot, scene, {.margin = margin}), from, to, 50);
          for (const Isa isa : available_isas()) {
            tally.judge(require_checker(robot, scene, {.margin = margin, .isa = isa}), from, to,
                        deepest);
          }
        }
      }
      CHECK(tally.free > 10);
      CHECK(tally.blocked > 10);
      CHECK(tally.refused < tally.blocked);
    }
  }
}

}  // namespace
}  // namespace mneme::test
