// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/small_worlds.h"

#include <set>

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("planners are found by their names") {
    REQUIRE(!planners().empty());
    std::set<std::string_view> names;
    for (const PlannerEntry& planner : planners()) {
      CHECK(names.insert(planner.name).second);
      CHECK(find_planner(planner.name).value() == &planner);
      CHECK(bool(planner.plan));
      CHECK(!planner.summary.empty());
    }
    for (const char* unknown : {"", "RRT", "rrt_star"}) {
      const Error error = require_error(find_planner(unknown));
      CHECK(error.code == ErrorCode::invalid);
      CHECK(contains(error.message, "expected one of rrt_connect, rrt, prm"));
    }
    CHECK(find_planner("RRTConnect").error().message.ends_with("did you mean 'rrt_connect'?"));
    CHECK(find_planner("ompl:RRTConnect").error().code == ErrorCode::unsupported);
  }

  TEST_CASE("every planner has a test that runs the planner flow") {
    for (const PlannerEntry& planner : planners()) {
      const std::string name = "tests/planning/" + std::string(planner.name) + "_test.cpp";
      CHECK_MESSAGE(contains(read_file(source_file(name)), "planning/planner_flow.h"), name);
    }
  }

  TEST_CASE("every status has a name of its own") {
    std::set<std::string_view> names;
    for (const PlanStatus status :
         {PlanStatus::solved, PlanStatus::timeout, PlanStatus::iteration_limit,
          PlanStatus::node_limit, PlanStatus::cancelled, PlanStatus::invalid_start,
          PlanStatus::invalid_goal}) {
      CHECK(names.insert(to_string(status)).second);
    }
    CHECK(to_string(PlanStatus::solved) == "solved");
    CHECK(names.count("unknown") == 0);
  }

  TEST_CASE("the default range depends on whether the robot is planar") {
    CHECK(default_range(planar8()) == default_range(thick_arm({1, 1})));
    CHECK(default_range(spatial_arm()) == default_range(gantry()));
    CHECK(default_range(planar8()) > 0.1);
    CHECK(default_range(gantry()) > 0.1);
  }

  TEST_CASE("default settings lie within their own ranges and have names of their own") {
    PlanSettings settings;
    std::set<std::string> names;
    visit_settings(settings,
                   [&](const char* name, auto& value, auto least, auto most, const char* sentence) {
                     CHECK(names.insert(name).second);
                     using Setting = std::remove_reference_t<decltype(value)>;
                     if constexpr (SettingTraits<Setting>::kIsOptional) {
                       CHECK(!value.has_value());
                       CHECK(least < most);
                     } else {
                       CHECK(value >= least);
                       CHECK(value <= most);
                     }
                     CHECK(std::string(sentence).size() > 10);
                   });
    CHECK(names.size() == 19);
  }
}

}  // namespace mneme::test
