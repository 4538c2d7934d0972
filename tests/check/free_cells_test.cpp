// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "check/free_cells.h"
#include "collision/random_worlds.h"

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace mneme::test {
namespace {

using internal::FreeCells, internal::LinkDistances, internal::MotionShare;

/// The joints between a post and the bar above it.
struct BarJoints {
  std::string roll = "fixed";   ///< type: a spacer rolls about the post's axis, or not
  std::string slide = "fixed";  ///< type: the bar slides along itself, or not
};

/// A post, and a bar above it that tilts on a spacer.
std::string tilting_bar(const BarJoints& joints, const std::string& post = "0 0 0") {
  return R"(<robot name="bar"><link name="post"><collision><origin xyz=")" + post + R"("/>
      <geometry><capsule radius="0.05" length="0.2"/></geometry></collision></link>
    <link name="spacer"/>
    <link name="sleeve"/>
    <link name="bar"><collision><origin xyz="0.05 0 0.04" rpy="0 1.5707963267948966 0"/>
      <geometry><capsule radius="0.03" length="0.5"/></geometry></collision></link>
    <joint name="roll" type=")" +
         joints.roll + R"("><parent link="post"/><child link="spacer"/>
      <origin xyz="0 0 0.2"/><axis xyz="0 0 1"/><limit lower="-3" upper="3"/></joint>
    <joint name="tilt" type="revolute"><parent link="spacer"/><child link="sleeve"/>
      <axis xyz="0 1 0"/><limit lower="-1.5" upper="1.5"/></joint>
    <joint name="slide" type=")" +
         joints.slide + R"("><parent link="sleeve"/><child link="bar"/>
      <axis xyz="1 0 0"/><limit lower="-0.1" upper="0.1"/></joint></robot>)";
}

/// Metres between post and bar by the distance of capsules, which cells share no code with.
double distance_at(const Robot& robot, const LinkDistances& links, std::vector<float> q) {
  const auto posed = links.posed(robot.link_poses(Configuration(q.begin(), q.end())));
  return links.between_spheres(posed, 0, robot.find_link("bar").value(), 1);
}

struct Tally {
  int proven = 0, unproven = 0, touching = 0;
};

/// Random motions: outside of the unproven share the links are apart.
Tally check_motions(const Robot& robot, int count) {
  const LinkDistances links(robot);
  const auto cells = FreeCells::make(robot, links, 0, robot.find_link("bar").value());
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
  TEST_CASE("links are apart where cells prove it, with one, two or three joints between them") {
    for (const char* roll : {"revolute", "continuous", "fixed"}) {
      for (const char* slide : {"prismatic", "fixed"}) {
        for (const char* post : {"0 0 0", "0.06 0 0"}) {
          CAPTURE(roll);
          CAPTURE(slide);
          CAPTURE(post);
          const Robot robot = require_parsed(tilting_bar({roll, slide}, post));
          // Motions over the whole ranges of three joints are seldom proven.
          const Tally tally = check_motions(robot, robot.joint_count() == 3 ? 2000 : 100);
          CHECK(tally.proven > 10);
          CHECK(tally.unproven > 10);
          CHECK(tally.touching > 10);
        }
      }
    }
  }

  TEST_CASE("a body that is not round about the roll joint's axis is proven apart less often") {
    const BarJoints joints{"revolute", "prismatic"};
    const Tally round = check_motions(require_parsed(tilting_bar(joints)), 100);
    const Tally oblong = check_motions(require_parsed(tilting_bar(joints, "0.06 0 0")), 100);
    CHECK(oblong.proven < round.proven);
  }

  TEST_CASE(
      "cells say the same whether they are proven in advance, found or proven at their first use") {
    const Robot robot = require_parsed(tilting_bar({"revolute"}, "0.06 0 0"));
    const LinkDistances links(robot);
    const int bar = robot.find_link("bar").value();
    const auto cells = FreeCells::make(robot, links, 0, bar);
    const TemporaryDirectory files;
    const internal::ContentCache cache(files / "cache", "cells");
    const auto compare = [&] {
      const auto proven = FreeCells::make(robot, links, 0, bar);
      for (const auto& proofs : proven) proofs->prove_all(cache);
      Rng rng(7);
      const std::vector<float> states = random_states(robot, 200, rng);
      for (std::size_t i = 0; i < 200; ++i) {
        const std::vector<float> q = {states[2 * i], states[2 * i + 1]};
        for (std::size_t k = 0; k < cells.size(); ++k) {
          CHECK(cells[k]->unproven(q, {}, {}).has_value() ==
                proven[k]->unproven(q, {}, {}).has_value());
        }
      }
    };
    compare();
    const auto stored = [&] {
      std::vector<std::string> names;
      for (const auto& entry : std::filesystem::directory_iterator(files / "cache")) {
        names.push_back(entry.path().filename().string());
      }
      return names;
    };
    CHECK(stored().size() == cells.size());
    compare();
    // Other links have other proofs.
    const Robot other = require_parsed(tilting_bar({"revolute"}, "0.05 0 0"));
    for (const auto& proofs : FreeCells::make(other, LinkDistances(other), 0, bar)) {
      proofs->prove_all(cache);
    }
    CHECK(stored().size() == 2 * cells.size());
  }
}

TEST_SUITE("unit") {
  TEST_CASE("a state at a limit or barely beyond it is in a cell, one far beyond it is not") {
    const Robot robot = require_parsed(tilting_bar({}, "0 0 -5"));
    const auto cells =
        FreeCells::make(robot, LinkDistances(robot), 0, robot.find_link("bar").value());
    REQUIRE(cells.size() == 1);
    for (const float tilt : {-1.5f, 0.0f, 1.5f, 1.50001f}) {
      CHECK_FALSE(cells[0]->unproven(std::vector<float>{tilt}, {}, {}));
    }
    CHECK(cells[0]->unproven(std::vector<float>{2.0f}, {}, {}));
  }

  TEST_CASE("four joints between links have no cells, three have if one rolls a link") {
    const auto arm = [](const std::string& type, const std::string& last) {
      const auto joint = [&](int i, const std::string& kind) {
        return fmt::format(R"(<joint name="{0}" type="{1}"><parent link="l{0}"/>
          <child link="l{2}"/><axis xyz="1 0 0"/><origin xyz="1 0 0"/>
          <limit lower="-1" upper="1"/></joint>)",
                           i, kind, i + 1);
      };
      const std::string ball =
          "<collision><geometry><sphere radius='0.1'/></geometry></collision></link>";
      return require_parsed("<robot name='arm'><link name='l0'>" + ball +
                            "<link name='l1'/><link name='l2'/><link name='l3'/><link name='l4'>" +
                            ball + joint(0, type) + joint(1, "revolute") + joint(2, "revolute") +
                            joint(3, last) + "</robot>");
    };
    const auto has_cells = [](const Robot& robot) {
      return !FreeCells::make(robot, LinkDistances(robot), 0, 4).empty();
    };
    CHECK_FALSE(has_cells(arm("revolute", "revolute")));
    CHECK_FALSE(has_cells(arm("prismatic", "prismatic")));
    CHECK(has_cells(arm("prismatic", "fixed")));
    CHECK(has_cells(arm("fixed", "prismatic")));
  }
}

}  // namespace
}  // namespace mneme::test
