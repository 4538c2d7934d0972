// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels in front of triangles that are nearly segments.
#include "collision/random_worlds.h"
#include "collision/walking_robots.h"
#include "geometry/random_compounds.h"
#include "geometry/slivers.h"

#include <algorithm>
#include <cmath>

namespace mneme::test {
namespace {

/// Rounding of a distance from slivers within a metre or two in single precision.
constexpr double kSliverDoubt = 2e-5;

double gap_by_sections(const Robot& robot, const std::vector<Triangle>& slivers,
                       const Configuration& q) {
  const std::vector<Transform> poses = robot.link_poses(q);
  double least = 1;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (const Capsule& own : capsules_of(robot.links()[i], poses[i])) {
      for (const Triangle& sliver : slivers) {
        least = std::min(least, distance_by_sections(own.a, own.b, sliver) - own.radius);
      }
    }
  }
  return least;
}

/// A configuration of the sliding hand with a link about its radius away from a sliver.
Configuration configuration_beside(const Robot& robot, const Triangle& sliver, Rng& rng) {
  Configuration q = random_configuration(robot, rng);
  std::fill_n(q.begin(), 3, 0.0);
  const std::size_t link = robot.links().size() - 1 - rng.index(2);
  const Capsule own = capsules_of(robot.links()[link], robot.link_poses(q)[link]).front();
  const double away = own.radius + rng.uniform(-1, 1) * std::pow(10, rng.uniform(-4.5, -1));
  const Vec3 shift = random_point_of(sliver, rng) + away * random_vector(rng, 1).normalized() -
                     (own.a + rng.uniform(0, 1) * (own.b - own.a));
  for (int axis = 0; axis < 3; ++axis) q[static_cast<std::size_t>(axis)] = shift[axis];
  return q;
}

TEST_SUITE("oracle") {
  TEST_CASE("no state is called free that touches a sliver, and none touching that does not") {
    constexpr std::uint64_t kSeed = 321;
    Rng rng(kSeed);
    int free = 0, touching = 0;
    for (int i = 0; i < rounds(40); ++i) {
      const Robot robot = sliding_hand(i % 2 == 0);
      std::vector<Triangle> slivers;
      for (int k = 0; k < 4; ++k) slivers.push_back(random_sliver(rng));
      const Scene scene{"slivers", {{"slivers", {compound_of(slivers)}}}};
      std::vector<float> rows;
      for (int k = 0; k < 160; ++k) {
        const Configuration q = configuration_beside(robot, slivers[rng.index(4)], rng);
        for (const double value : q) rows.push_back(static_cast<float>(value));
      }
      const auto alone = check_all(require_checker(robot, {}), rows);
      std::vector<double> gaps;
      for (std::size_t k = 0; k < alone.size(); ++k) {
        const auto q = row(rows, k, robot);
        gaps.push_back(gap_by_sections(robot, slivers, {q.begin(), q.end()}));
        if (alone[k] != 0) ++(gaps[k] < 0 ? touching : free);
      }
      for (const Isa isa : available_isas()) {
        const auto is_valid = check_all(require_checker(robot, scene, {.isa = isa}), rows);
        for (std::size_t k = 0; k < alone.size(); ++k) {
          if (alone[k] == 0 || std::abs(gaps[k]) <= kSliverDoubt) continue;
          INFO("seed " << kSeed << ", scene " << i << ", state " << k << ", " << to_string(isa));
          INFO("gap " << gaps[k]);
          CHECK((is_valid[k] != 0) == (gaps[k] > 0));
        }
      }
    }
    MESSAGE(free << " free states and " << touching << " that touch");
    CHECK(free > 500);
    CHECK(touching > 500);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("a ball beside a sliver touches it though rounding turns its plane away") {
    const Vec3 a(0.31, 0.10, 0.77), p(-0.47125876, 0.89125878, 1.56125879);
    const Triangle sliver{a, a + Vec3(-0.774, 0.774, 0.774), a + Vec3(-0.9, 0.9, 0.9)};
    Robot::Parts parts = parts_named("ball");
    hang_next(parts, JointType::prismatic, p, Vec3::UnitX(), 0.5, {{Vec3::Zero(), 0.02}});
    const Robot robot = robot_of(parts);
    // With its image the coordinates in the kernels are these.
    const std::vector<Triangle> both = {sliver, {-sliver.a, -sliver.b, -sliver.c}};
    const Scene scene{"sliver", {{"sliver", {compound_of(both)}}}};
    for (const Isa isa : available_isas()) {
      INFO(to_string(isa));
      CHECK(check_all(require_checker(robot, scene, {.isa = isa}), {0, 0.25f}) ==
            std::vector<std::uint8_t>{0, 1});
    }
  }
}

}  // namespace
}  // namespace mneme::test
