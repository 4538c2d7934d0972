// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/support.h"

#include <fmt/format.h>

#include <cmath>

namespace mneme::test {
namespace {

CollisionChecker checker_of(const std::vector<std::array<double, 3>>& circles) {
  auto checker = CollisionChecker::make(planar8(), make_circle_scene("circles", circles));
  REQUIRE(checker.has_value());
  return *checker;
}

const Configuration kStraight(8, 0.0);
const Configuration kUp = {1.5, 0, 0, 0, 0, 0, 0, 0};

TEST_SUITE("unit") {
  TEST_CASE("a query between free configurations is not refused") {
    CHECK(!refuse_query(checker_of({{-5, 0, 1}}), {kStraight, {kUp}}).has_value());
  }

  TEST_CASE("a start in contact names the link and the obstacle") {
    const auto refused = refuse_query(checker_of({{5, 0, 1}}), {kStraight, {kUp}});
    REQUIRE(refused.has_value());
    CHECK(refused->status == PlanStatus::invalid_start);
    CHECK(refused->message.find("start") != std::string::npos);
    CHECK(refused->message.find("link_3") != std::string::npos);
    CHECK(refused->message.find("circle_1") != std::string::npos);
  }

  TEST_CASE("what touches says how deep") {
    const auto refused = refuse_query(checker_of({{5, 0.9, 1}}), {kStraight, {kUp}});
    REQUIRE(refused.has_value());
    const double depth = 1e3 * checker_of({{5, 0.9, 1}}).contacts(kStraight)[0].distance;
    CHECK(refused->message.ends_with(fmt::format("'circle_1' by {:.2g} mm", -depth)));
  }

  TEST_CASE("goals in contact are left out with a note, unless all are") {
    const CollisionChecker checker = checker_of({{5, 0, 1}});
    std::vector<Configuration> goals = {kStraight, kUp, kStraight};
    const std::vector<std::string> notes = drop_goals_in_contact(checker, goals);
    CHECK(goals == std::vector<Configuration>{kUp});
    REQUIRE(notes.size() == 2);
    CHECK(notes[0].starts_with("goal 0 is in contact: link 'link_"));
    CHECK(notes[1].starts_with("goal 2 is in contact: link 'link_"));
    CHECK(notes[1].ends_with(": left out"));

    std::vector<Configuration> all = {kStraight, kStraight};
    CHECK(drop_goals_in_contact(checker, all).empty());
    CHECK(all.size() == 2);
    std::vector<Configuration> wrong = {kUp, Configuration(3, 0.0)};
    CHECK(drop_goals_in_contact(checker, wrong).empty());
    CHECK(wrong.size() == 2);
  }

  TEST_CASE("what is only within the margin is not said to touch, and comes last") {
    CheckerSettings settings;
    settings.margin = 1.5;
    const auto distant =
        CollisionChecker::make(planar8(), make_circle_scene("circles", {{{5, 2, 1}}}), settings);
    REQUIRE(distant.has_value());
    const auto refused = refuse_query(*distant, {kStraight, {kUp}});
    REQUIRE(refused.has_value());
    CHECK(refused->message.starts_with("start is within the margin of 1.5 m: link 'link_"));
    CHECK(refused->message.find("is 1 m from obstacle 'circle_1'") != std::string::npos);
    CHECK(refused->message.find("touches") == std::string::npos);

    const auto both = CollisionChecker::make(
        planar8(), make_circle_scene("circles", {{{2.5, 2, 1}, {6.5, 0, 0.2}}}), settings);
    REQUIRE(both.has_value());
    const auto touching = refuse_query(*both, {kStraight, {kUp}});
    REQUIRE(touching.has_value());
    CHECK(touching->message.starts_with("start is in contact: link 'link_"));
    CHECK(touching->message.find("touches obstacle 'circle_2'") <
          touching->message.find("m from obstacle 'circle_1'"));
  }

  TEST_CASE("of several goals the one that is wrong is numbered") {
    Configuration broken = kUp;
    broken[3] = std::nan("");
    const auto refused = refuse_query(checker_of({}), {kStraight, {kUp, broken}});
    REQUIRE(refused.has_value());
    CHECK(refused->status == PlanStatus::invalid_goal);
    CHECK(refused->message.find("goal 1") != std::string::npos);
  }

  TEST_CASE("a query without a goal is refused") {
    const auto refused = refuse_query(checker_of({}), {kStraight, {}});
    REQUIRE(refused.has_value());
    CHECK(refused->status == PlanStatus::invalid_goal);
  }
}

}  // namespace
}  // namespace mneme::test
