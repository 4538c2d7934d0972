// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "check/free_cells.h"
#include "collision/random_worlds.h"

#include <optional>
#include <string>
#include <vector>

namespace mneme::test {
namespace {

using internal::FreeCells, internal::LinkDistances, internal::MotionShare;

/// A post, and a bar above it that tilts on a spacer which rolls about the post's axis, or not.
std::string tilting_bar(const std::string& roll, const std::string& post = "0 0 0") {
  return R"(<robot name="bar"><link name="post"><collision><origin xyz=")" + post + R"("/>
      <geometry><capsule radius="0.05" length="0.2"/></geometry></collision></link>
    <link name="spacer"/>
    <link name="bar"><collision><origin xyz="0.05 0 0.04" rpy="0 1.5707963267948966 0"/>
      <geometry><capsule radius="0.03" length="0.5"/></geometry></collision></link>
    <joint name="roll" type=")" +
         roll + R"("><parent link="post"/><child link="spacer"/>
      <origin xyz="0 0 0.2"/><axis xyz="0 0 1"/><limit lower="-3" upper="3"/></joint>
    <joint name="tilt" type="revolute"><parent link="spacer"/><child link="bar"/>
      <axis xyz="0 1 0"/><limit lower="-1.5" upper="1.5"/></joint></robot>)";
}

/// Metres between post and bar by the distance of capsules, which cells share no code with.
double distance_at(const Robot& robot, const LinkDistances& links, std::vector<float> q) {
  const auto posed = links.posed(robot.link_poses(Configuration(q.begin(), q.end())));
  return links.between_spheres(posed, 0, 2, 1);
}

struct Tally {
  int proven = 0, unproven = 0, touching = 0;
};

/// Random motions: outside of the unproven share the links are apart.
Tally check_motions(const Robot& robot, int count) {
  const LinkDistances links(robot);
  const auto cells = FreeCells::make(robot, links, 0, 2);
  REQUIRE_FALSE(cells.empty());
  Rng rng(5);
  Tally tally;
  for (int i = 0; i < count; ++i) {
    const std::vector<float> states = random_states(robot, 2, rng);
    const std::size_t joints = states.size() / 2;
    const std::vector<float> from(states.begin(),
                                  states.begin() + static_cast<std::ptrdiff_t>(joints));
    std::vector<float> delta(joints);
    for (std::size_t j = 0; j < joints; ++j) delta[j] = states[joints + j] - from[j];
    std::optional<MotionShare> rest = MotionShare{};
    for (const auto& proofs : cells) {
      if (rest) rest = proofs->unproven(from, delta, *rest);
    }
    ++(rest ? tally.unproven : tally.proven);
    for (int step = 0; step <= 50; ++step) {
      const double share = step / 50.0;
      std::vector<float> q = from;
      for (std::size_t j = 0; j < joints; ++j) q[j] += static_cast<float>(share) * delta[j];
      const double distance = distance_at(robot, links, q);
      tally.touching += distance <= 0 ? 1 : 0;
      if (rest && share >= rest->first && share <= rest->last) continue;
      INFO("motion " << i << " at " << share);
      CHECK(distance >= internal::kCellSpare - 1e-6);
    }
  }
  return tally;
}

TEST_SUITE("law") {
  TEST_CASE("links are apart where cells prove it, whatever the roll joint does") {
    for (const char* roll : {"revolute", "continuous", "fixed"}) {
      CAPTURE(roll);
      const Tally tally = check_motions(require_parsed(tilting_bar(roll)), 100);
      CHECK(tally.proven > 10);
      CHECK(tally.unproven > 10);
      CHECK(tally.touching > 10);
    }
  }

  TEST_CASE("a body that is not round about the roll joint's axis is proven apart less often") {
    const Tally round = check_motions(require_parsed(tilting_bar("revolute")), 100);
    const Tally oblong = check_motions(require_parsed(tilting_bar("revolute", "0.06 0 0")), 100);
    CHECK(oblong.proven < round.proven);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("a state at a limit or barely beyond it is in a cell, one far beyond it is not") {
    const Robot robot = require_parsed(tilting_bar("fixed", "0 0 -5"));
    const auto cells = FreeCells::make(robot, LinkDistances(robot), 0, 2);
    REQUIRE(cells.size() == 1);
    for (const float tilt : {-1.5f, 0.0f, 1.5f, 1.50001f}) {
      CHECK_FALSE(cells[0]->unproven(std::vector<float>{tilt}, {}, {}));
    }
    CHECK(cells[0]->unproven(std::vector<float>{2.0f}, {}, {}));
  }

  TEST_CASE("two joints that both bring links nearer have no cells") {
    const Robot robot = require_parsed(R"(<robot name="arm">
      <link name="a"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
      <link name="b"/><link name="c"/>
      <link name="d"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
      <joint name="1" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
        <limit lower="-1" upper="1"/></joint>
      <joint name="2" type="revolute"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/>
        <origin xyz="1 0 0"/><limit lower="-1" upper="1"/></joint>
      <joint name="3" type="prismatic"><parent link="c"/><child link="d"/><axis xyz="1 0 0"/>
        <origin xyz="1 0 0"/><limit lower="-1" upper="1"/></joint></robot>)");
    CHECK(FreeCells::make(robot, LinkDistances(robot), 0, 3).empty());
  }
}

}  // namespace
}  // namespace mneme::test
