// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/spheres.h"

#include "planning/end_contacts.h"
#include "support/support.h"

#include <fmt/format.h>

namespace mneme::test {
namespace {

CollisionChecker checker_of(const std::vector<std::array<double, 3>>& circles) {
  return require(CollisionChecker::make(planar8(), make_circle_scene("circles", circles)));
}

/// Two links in a row, the second one of which is a box in spheres.
Robot approximated_arm() {
  const auto parts = require(parse_robot_parts(
      R"(<robot name="arm"><link name="l0"/>
      <link name="l1"><collision><origin xyz="0.4 0 0"/><geometry><box size="1 0.2 0.2"/></geometry>
      </collision></link><link name="l2"/>
      <joint name="j1" type="revolute"><parent link="l0"/><child link="l1"/>
      <origin xyz="1 0 0"/><axis xyz="0 0 1"/><limit lower="-2" upper="2" velocity="1"/></joint>
      <joint name="j2" type="revolute"><parent link="l1"/><child link="l2"/>
      <origin xyz="1 0 0"/><axis xyz="0 0 1"/><limit lower="-2" upper="2" velocity="1"/></joint>
      </robot>)",
      "arm.urdf"));
  return require(make_robot(require(approximate_robot(parts)).parts));
}

const Configuration kStraight(8, 0.0);
const Configuration kUp = {1.5, 0, 0, 0, 0, 0, 0, 0};

TEST_SUITE("unit") {
  TEST_CASE("a query between free configurations is not refused") {
    CHECK(!refuse_query(checker_of({{-5, 0, 1}}), {kStraight, {kUp}}).has_value());
  }

  TEST_CASE("a start in contact names the link and the obstacle") {
    const auto refused = require(refuse_query(checker_of({{5, 0, 1}}), {kStraight, {kUp}}));
    CHECK(refused.status == PlanStatus::invalid_start);
    CHECK(contains(refused.message, "start"));
    CHECK(contains(refused.message, "link_3"));
    CHECK(contains(refused.message, "circle_1"));
  }

  TEST_CASE("what touches says how deep, and at least how deep where that is not known") {
    // The links of the planar arm are 1 mm thick.
    for (const auto& [y, words] :
         {std::pair(1.0003, "' by 0.2 mm"), {0.9, "' by at least 0.5 mm"}}) {
      const auto refused = require(refuse_query(checker_of({{5, y, 1}}), {kStraight, {kUp}}));
      INFO(refused.message);
      CHECK(refused.message.ends_with(words));
    }
  }

  TEST_CASE("spheres that touch say how far they stick out, and where the exact geometry is") {
    // The arm's second link is a box between x = 0.9 and x = 1.9, 0.2 m thick.
    const Robot robot = approximated_arm();
    const double excess = 1e3 * robot.links()[1].approximation->excess;
    REQUIRE(excess > 3);
    const auto refuse = [&](const Shape& shape, double margin = 0) {
      const auto checker =
          CollisionChecker::make(robot, {"scene", {{"shelf", {shape}}}}, {.margin = margin});
      REQUIRE(checker.has_value());
      const auto refused =
          require(refuse_query(*checker, {Configuration{0, 0}, {Configuration{0, 1}}}));
      return refused.message;
    };
    const Box above{{Eigen::Matrix3d::Identity(), {1.4, 0, 0.202}}, {0.5, 0.1, 0.1}};
    const std::string message = refuse(above);
    INFO(message);
    CHECK(message.starts_with(
        "start is in contact: link 'l1' touches obstacle 'shelf' with spheres by "));
    CHECK(contains(
        message, fmt::format(" mm (the spheres stick out by up to {:.2g} mm; the exact geometry is "
                             "2 mm away). Try finer spheres (`mneme robot spheres --excess "
                             "0.002`), or `allow` what may touch",
                             excess)));
    Box lower = above;
    lower.pose.translation.z() -= 0.003;
    CHECK(refuse(lower).ends_with(" mm; the exact geometry touches, too)"));
    CHECK(refuse(Sphere{{1.4, 0, 0.01}, 0.01}).ends_with(" mm; the exact geometry touches, too)"));
    CHECK(refuse(above, 0.0015).ends_with("the exact geometry is 2 mm away)"));
    Box higher = above;
    higher.pose.translation.z() += 0.2;
    CHECK(contains(refuse(higher, 0.3), "the exact geometry is 202 mm away)"));
  }

  TEST_CASE("what is carried says how far its spheres stick out, which nothing makes finer") {
    const Robot robot =
        attach(approximated_arm(), {{"rod", "l2", {Box{{}, Vec3::Constant(0.05)}}}}).value();
    const Box ahead{{Eigen::Matrix3d::Identity(), {2.152, 0, 0}}, {0.1, 0.1, 0.1}};
    const auto checker = require(CollisionChecker::make(robot, {"scene", {{"wall", {ahead}}}}));
    const auto refused =
        require(refuse_query(checker, {Configuration{0, 0}, {Configuration{0, 1}}}));
    INFO(refused.message);
    CHECK(refused.message.starts_with("start is in contact: link 'rod' touches obstacle 'wall'"));
    CHECK(contains(refused.message,
                   "(the spheres stick out by up to 15 mm; the exact geometry is 2 mm away). What "
                   "the robot holds may leave contact"));
    CHECK(refused.message.ends_with("`allow: [{pair: [rod, wall], at_ends: METRES}]`"));
  }

  TEST_CASE("an end is valid if a query with it is not refused, also closer than a path may go") {
    const std::array<double, 3> kTouching = {5, 1.0003, 1}, kClose = {5, 1.00055, 1},
                                kFar = {5, 1.1, 1};
    for (const auto& [circle, is_clear, is_valid] :
         {std::tuple(kTouching, false, false), {kClose, false, true}, {kFar, true, true}}) {
      const double y = circle[1];
      CAPTURE(y);
      const CollisionChecker checker = checker_of({circle});
      CHECK(internal::is_clear(checker, kStraight) == is_clear);
      CHECK(internal::is_valid_end(checker, kStraight) == is_valid);
      CHECK(refuse_query(checker, {kUp, {kStraight}}).has_value() != is_valid);
    }
  }

  TEST_CASE("invalid goals are ignored with a note, unless all are") {
    const CollisionChecker checker = checker_of({{5, 0, 1}});
    std::vector<Configuration> goals = {kStraight, kUp, kStraight};
    const std::vector<std::string> notes = drop_invalid_goals(checker, goals);
    CHECK(goals == std::vector<Configuration>{kUp});
    REQUIRE(notes.size() == 2);
    CHECK(notes[0].starts_with("goal 1 is in contact: link 'link_"));
    CHECK(notes[1].starts_with("goal 3 is in contact: link 'link_"));
    CHECK(notes[1].ends_with("; this goal is ignored"));

    std::vector<Configuration> all = {kStraight, kStraight};
    CHECK(drop_invalid_goals(checker, all).empty());
    CHECK(all.size() == 2);
    std::vector<Configuration> wrong = {kUp, Configuration(3, 0.0)};
    Configuration beyond = kUp;
    beyond[1] = 99;
    wrong.push_back(beyond);
    const std::vector<std::string> faults = drop_invalid_goals(checker, wrong);
    CHECK(wrong == std::vector<Configuration>{kUp});
    REQUIRE(faults.size() == 2);
    CHECK(faults[0].starts_with("goal 2: there are 3 values"));
    CHECK(faults[1].starts_with("goal 3: joint '"));
    std::vector<Configuration> both = {beyond, beyond};
    CHECK(drop_invalid_goals(checker, both).empty());
    CHECK(both.size() == 2);
  }

  TEST_CASE("what is only within the margin is not said to touch, and comes last") {
    CheckerSettings settings;
    settings.margin = 1.5;
    const auto distant =
        CollisionChecker::make(planar8(), make_circle_scene("circles", {{{5, 2, 1}}}), settings);
    REQUIRE(distant.has_value());
    const auto refused = require(refuse_query(*distant, {kStraight, {kUp}}));
    CHECK(refused.message.starts_with("start is within the margin of 1.5 m: link 'link_"));
    CHECK(contains(refused.message, "is 1 m from obstacle 'circle_1'"));
    CHECK(!contains(refused.message, "touches"));

    const auto both = require(CollisionChecker::make(
        planar8(), make_circle_scene("circles", {{{2.5, 2, 1}, {6.5, 0, 0.2}}}), settings));
    const auto touching = require(refuse_query(both, {kStraight, {kUp}}));
    CHECK(touching.message.starts_with("start is in contact: link 'link_"));
    CHECK(touching.message.find("touches obstacle 'circle_2'") <
          touching.message.find("m from obstacle 'circle_1'"));
  }

  TEST_CASE("a tilt names the angle that the constraint was given") {
    const Vec3 x = Vec3::UnitX();
    CheckerSettings settings;
    settings.constraints = {{"link_2", x, x, 0.28}};
    const auto checker = require(CollisionChecker::make(planar8(), Scene(), settings));
    const auto message_of = [&](double turn) {
      Configuration tilted = kStraight;
      tilted[0] = turn;
      return require(refuse_query(checker, {tilted, {kStraight}})).message;
    };
    CHECK(message_of(0.5) == "start: link_2 is tilted by 0.5 rad, the constraint allows 0.28");
    CHECK(message_of(0.279995) ==
          "start: link_2 is tilted by 0.279995 rad, the constraint allows 0.28 less a margin of "
          "1e-05");
  }

  TEST_CASE("of several goals the one that is wrong is numbered") {
    Configuration broken = kUp;
    broken[3] = std::nan("");
    const auto refused = require(refuse_query(checker_of({}), {kStraight, {kUp, broken}}));
    CHECK(refused.status == PlanStatus::invalid_goal);
    CHECK(contains(refused.message, "goal 2"));
  }

  TEST_CASE("a query without a goal is refused") {
    const auto refused = require(refuse_query(checker_of({}), {kStraight, {}}));
    CHECK(refused.status == PlanStatus::invalid_goal);
  }
}

}  // namespace
}  // namespace mneme::test
