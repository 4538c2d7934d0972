// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ompl/planner_table.h"

#include <set>

#include "ompl/silence.h"
#include "ompl/small_problems.h"

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("every planner is found under its name, with and without the prefix") {
    std::set<std::string_view> names;
    for (const std::string_view name : ompl_planner_names()) {
      CHECK(names.insert(name).second);
      const auto* planner = mneme::ompl::find_ompl_planner(name);
      REQUIRE(planner != nullptr);
      CHECK(planner->name == name);
      CHECK(mneme::ompl::find_ompl_planner("ompl:" + std::string(name)) == planner);
    }
    for (const char* name : {"RRTConnect", "BKPIECE1", "KPIECE1", "BiEST", "STRIDE", "SBL",
                             "BITstar", "PRM", "LazyPRM", "RRTstar"}) {
      CHECK_MESSAGE(names.count(name) == 1, name);
    }
    CHECK(mneme::ompl::find_ompl_planner("rrtconnect") == nullptr);
    CHECK(mneme::ompl::find_ompl_planner("ompl:") == nullptr);
  }

  TEST_CASE("a range is set where the planner has one, and 0 leaves OMPL's") {
    const mneme::ompl::Silence silence;
    const auto information = mneme::ompl::make_space_information(checker_of(gap_problem()));
    const auto connect = mneme::ompl::find_ompl_planner("RRTConnect")->make(information);
    const auto range = [&] { return std::stod(connect->params()["range"].getValue()); };
    mneme::ompl::set_range(*connect, 0);
    CHECK(range() == 0);
    mneme::ompl::set_range(*connect, 0.4);
    CHECK(range() == 0.4);
    mneme::ompl::set_range(*connect, 1e-9);
    CHECK(range() == 1e-9);
    const auto prm = mneme::ompl::find_ompl_planner("PRM")->make(information);
    CHECK_NOTHROW(mneme::ompl::set_range(*prm, 0.4));
  }
}

}  // namespace mneme::test
