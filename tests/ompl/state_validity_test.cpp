// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ompl/small_problems.h"

#include <ompl/base/spaces/SO2StateSpace.h>

namespace mneme::test {
namespace {

constexpr std::uint64_t kValiditySeed = 20262;

/// Metres between the robot and the obstacles by exact distances, found by inflating the robot.
bool is_free_with_margin(const Problem& problem, const Configuration& q, double margin) {
  return make_checker(problem.robot, problem.scene, margin).contacts(q).empty();
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a state is valid if it is within limits and free of contact") {
    const Problem problem = gap_problem();
    const auto counters = std::make_shared<mneme::ompl::WorkCounters>();
    const auto information = mneme::ompl::make_space_information(checker_of(problem), counters);
    CHECK(information->isValid(state_of(information, problem.start).get()));
    CHECK(!information->isValid(state_of(information, {2.8, 0, 0}).get()));
    CHECK(counters->states.load() == 2);
    CHECK(!information->isValid(state_of(information, {-2, 3.5, 1}).get()));
    CHECK(counters->states.load() == 2);
  }

  TEST_CASE("a program's own compound space is checked through its reals") {
    const Problem problem = gap_problem();
    const auto turn = std::make_shared<ob::SO2StateSpace>();
    const auto rest = std::make_shared<ob::RealVectorStateSpace>(2);
    rest->setBounds(-kPi, kPi);
    const ob::StateSpacePtr space = turn + rest;
    const auto information = std::make_shared<ob::SpaceInformation>(space);
    information->setStateValidityChecker(
        mneme::ompl::make_state_validity(information, checker_of(problem)));
    information->setup();
    CHECK(information->isValid(state_of(information, problem.start).get()));
    CHECK(!information->isValid(state_of(information, {2.8, 0, 0}).get()));
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("clearance is the margin at which exact distances find the first contact") {
    const Problem problem = gap_problem();
    const auto information = mneme::ompl::make_space_information(checker_of(problem));
    const auto& validity = *information->getStateValidityChecker();
    Rng rng(kValiditySeed);
    INFO("seed ", kValiditySeed);
    int inside = 0;
    for (int trial = 0; trial < 60; ++trial) {
      const Configuration q = random_configuration(problem.robot, rng);
      const auto state = state_of(information, q);
      if (!validity.isValid(state.get())) continue;
      const double clearance = validity.clearance(state.get());
      REQUIRE(clearance >= 0);
      REQUIRE(clearance <= 1);
      CHECK(is_free_with_margin(problem, q, std::max(0.0, clearance - 2e-5)));
      if (clearance == 1) continue;
      ++inside;
      CHECK(!is_free_with_margin(problem, q, clearance + 1.1e-3));
    }
    CHECK(inside > 10);
  }
}

}  // namespace mneme::test
