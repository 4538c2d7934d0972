// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ompl/planner_table.h"
#include "ompl/small_problems.h"

#include <algorithm>
#include <set>

namespace mneme::test {
namespace {

ob::PlannerPtr make_planner(std::string_view name, const ob::SpaceInformationPtr& information) {
  const auto planners = mneme::ompl::ompl_planners();
  const auto found = std::ranges::find(planners, name, &mneme::ompl::OmplPlanner::name);
  REQUIRE(found != planners.end());
  return found->make(information);
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("every planner is found under its name, once, and only with the prefix") {
    std::set<std::string> names;
    for (const std::string& name : ompl_names()) {
      CHECK(names.insert(name).second);
      CHECK(ompl_planner(name).name == "ompl:" + name);
      CHECK(!find_planner(name).has_value());
    }
    for (const char* name : {"RRTConnect", "BKPIECE1", "KPIECE1", "BiEST", "STRIDE", "SBL",
                             "BITstar", "PRM", "LazyPRM", "RRTstar"}) {
      CHECK_MESSAGE(names.count(name) == 1, name);
    }
    for (const char* name : {"ompl:rrtconnect", "ompl:"}) {
      const Error error = require_error(find_planner(name));
      CHECK(error.code == ErrorCode::invalid);
      CHECK(contains(error.message, "ompl:RRTConnect"));
    }
  }

  TEST_CASE("planners that are added again are there once, after mneme's own") {
    add_ompl_planners();
    const std::vector<std::string> before = planner_names();
    add_ompl_planners();
    CHECK(planner_names() == before);
    CHECK(!before.front().starts_with("ompl:"));
  }

  TEST_CASE("a range is set where the planner has one, and 0 leaves OMPL's") {
    const mneme::ompl::Silence silence;
    const auto information = mneme::ompl::make_space_information(checker_of(gap_problem()));
    const auto connect = make_planner("RRTConnect", information);
    const auto range = [&] { return std::stod(connect->params()["range"].getValue()); };
    mneme::ompl::set_range(*connect, 0);
    CHECK(range() == 0);
    mneme::ompl::set_range(*connect, 0.4);
    CHECK(range() == 0.4);
    mneme::ompl::set_range(*connect, 1e-9);
    CHECK(range() == 1e-9);
    const auto prm = make_planner("PRM", information);
    CHECK_NOTHROW(mneme::ompl::set_range(*prm, 0.4));
  }
}

}  // namespace mneme::test
