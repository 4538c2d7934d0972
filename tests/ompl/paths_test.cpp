// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ompl/small_problems.h"

#include <ompl/base/spaces/SO2StateSpace.h>

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("a path survives the way to OMPL and back") {
    const Problem problem = gap_problem();
    const auto information = mneme::ompl::make_space_information(checker_of(problem));
    const Path path = {problem.start, {-3, 0.25, 0.5}, {3, -0.125, 0}, {0.5, 0, 0}};
    const og::PathGeometric states = mneme::ompl::to_ompl(path, information);
    REQUIRE(states.getStateCount() == 4);
    CHECK(states.length() == doctest::Approx(path_length(problem.robot, path)));
    const Path back = mneme::ompl::from_ompl(states, problem.robot);
    REQUIRE(back.size() == path.size());
    for (std::size_t i = 0; i < path.size(); ++i) {
      for (std::size_t j = 0; j < 3; ++j) CHECK(back[i][j] == doctest::Approx(path[i][j]));
    }
  }

  TEST_CASE("turns beyond half a turn come back normalized") {
    const Problem problem = gap_problem();
    const auto information = mneme::ompl::make_space_information(checker_of(problem));
    const Path back =
        mneme::ompl::from_ompl(mneme::ompl::to_ompl({{4, 0, 0}}, information), problem.robot);
    CHECK(back.at(0).at(0) == doctest::Approx(4 - 2 * kPi));
  }

  TEST_CASE("a path in a program's own compound space has one real per joint") {
    const Problem problem = gap_problem();
    const auto rest = std::make_shared<ob::RealVectorStateSpace>(2);
    rest->setBounds(-kPi, kPi);
    const ob::StateSpacePtr space = std::make_shared<ob::SO2StateSpace>() + rest;
    const auto information = std::make_shared<ob::SpaceInformation>(space);
    information->setStateValidityChecker([](const ob::State*) { return true; });
    information->setup();
    const Path path = {{-2, 0.5, 1}, {3, 0.25, -1}};
    const Path back =
        mneme::ompl::from_ompl(mneme::ompl::to_ompl(path, information), problem.robot);
    CHECK(back == path);
  }

  TEST_CASE("an empty path stays empty") {
    const Problem problem = gap_problem();
    const auto information = mneme::ompl::make_space_information(checker_of(problem));
    CHECK(mneme::ompl::from_ompl(mneme::ompl::to_ompl({}, information), problem.robot).empty());
  }
}

}  // namespace mneme::test
