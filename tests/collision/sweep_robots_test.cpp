// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "collision/sweeps.h"

#include <fmt/format.h>

namespace mneme::test {
namespace {

Configuration random_configuration_of(const Robot& robot, Rng& rng) {
  const std::vector<float> row = random_states(robot, 1, rng);
  return {row.begin(), row.end()};
}

/// A turning link, and on it a ball on a slide that follows it far beyond the slide's own limits.
Robot winding_arm(double multiplier, double offset) {
  return require_parsed(fmt::format(
      R"(<robot name="winding"><link name="base"/>
      <link name="drum"/>
      <link name="ball"><collision><geometry><sphere radius="0.01"/></geometry></collision></link>
      <joint name="turn" type="revolute"><parent link="base"/><child link="drum"/>
        <axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
      <joint name="slide" type="prismatic"><parent link="drum"/><child link="ball"/>
        <axis xyz="1 0 0"/><limit lower="0" upper="0.01" effort="1" velocity="1"/>
        <mimic joint="turn" multiplier="{}" offset="{}"/></joint></robot>)",
      multiplier, offset));
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a slide that follows another joint counts by how far it goes, not by its limits") {
    for (const auto& [multiplier, offset] : {std::pair{0.5, 0.0}, std::pair{0.0, 0.95}}) {
      const Robot robot = winding_arm(multiplier, offset);
      const double angle = 1.9, away = multiplier * angle + offset;
      const Vec3 where(away * std::cos(angle), away * std::sin(angle), 0);
      const Scene scene{"", {{"pea", {Sphere{where, 0.005}}}}};
      CHECK_FALSE(is_swept_free(robot, scene, Configuration{0}, Configuration{2}));
      CHECK(is_swept_free(robot, scene, Configuration{0}, Configuration{1.8}));
    }
  }

  TEST_CASE("huge limits of a slide cost nothing where it does not go") {
    Robot::Parts parts;
    parts.name = "tower";
    parts.links = {{.name = "base"},
                   {.name = "column"},
                   {.name = "tool", .spheres = {{Vec3(0.5, 0, 0), 0.05}}}};
    Joint turn{"turn", JointType::revolute, 0, 1, {}, Vec3::UnitZ(), -3, 3, 0};
    Joint lift{"lift", JointType::prismatic, 1, 2, {}, Vec3::UnitZ(), -1e6, 1e6, 0};
    parts.joints = {turn, lift};
    const auto robot = require(make_robot(std::move(parts)));
    const Scene scene{"", {{"ball", {Sphere{Vec3(0.5, 0, 0.2), 0.1}}}}};
    CheckCounters counters;
    const std::vector<float> from = {-1, 0}, to = {1, 0};
    CHECK(require_checker(robot, scene).is_sweep_valid(from, to, counters));
    CHECK(counters.states < 1000);
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("whatever the robot, no state of a free sweep is in contact by more than it may be") {
    constexpr std::uint64_t kSeed = 97;
    constexpr int kStates = 500;
    Rng rng(kSeed);
    SweepTally tally;
    for (int i = 0; i < 1500; ++i) {
      INFO("seed " << kSeed << ", motion " << i);
      const Robot robot = random_robot(rng);
      const Scene scene = random_scene(robot, 4, rng, small_shape);
      const CollisionChecker checker = require_checker(robot, scene);
      const Configuration from = random_configuration_of(robot, rng);
      const Configuration to = random_configuration_of(robot, rng);
      if (!checker.contacts(from).empty() || !checker.contacts(to).empty()) continue;
      tally.compare(checker, from, to, kStates);
      if (is_swept_free(robot, {}, from, to)) {
        CHECK(is_swept_free(checker, from, to, {.are_links_apart = true}) ==
              is_swept_free(checker, from, to));
      }
    }
    CHECK(tally.refused <= 3);
    CHECK(tally.free > 100);
    CHECK(tally.blocked > 100);
  }

  TEST_CASE("short motions are free together if they are one by one, and cost fewer states") {
    Rng rng(98);
    int free = 0, blocked = 0, differences = 0;
    CheckCounters together, alone;
    for (int i = 0; i < 600; ++i) {
      INFO("seed 98, chain " << i);
      const Robot robot = random_robot(rng);
      const CollisionChecker checker =
          require_checker(robot, random_scene(robot, 2, rng, small_shape));
      const SweepDetail detail{1e-4, i % 2 == 0, i % 3 == 0};
      Path chain = {random_configuration_of(robot, rng)};
      std::vector<float> rows(chain[0].begin(), chain[0].end());
      bool are_free = true;
      for (int k = 0; k < 1 + i % 20; ++k) {
        chain.push_back(chain.back());
        for (double& value : chain.back()) value += rng.uniform(-0.02, 0.02);
        const SweepDetail own{detail.margin, detail.is_from_start && k == 0,
                              detail.is_to_goal && k == i % 20};
        const std::vector<float> from(chain[chain.size() - 2].begin(),
                                      chain[chain.size() - 2].end());
        const std::vector<float> to(chain.back().begin(), chain.back().end());
        rows.insert(rows.end(), to.begin(), to.end());
        are_free = checker.is_sweep_valid(from, to, alone, own) && are_free;
      }
      const bool are_free_together = checker.are_sweeps_valid(rows, together, detail);
      ++(are_free_together ? free : blocked);
      differences += are_free_together != are_free ? 1 : 0;
      for (std::size_t k = 1; are_free_together && k < chain.size(); ++k) {
        CHECK(deepest_contact(checker, chain[k - 1], chain[k], 20) <= kSweepTolerance);
      }
    }
    CHECK(differences <= 6);
    CHECK(free > 100);
    CHECK(blocked > 100);
    CHECK(2 * together.states < alone.states);
  }
}

}  // namespace mneme::test
