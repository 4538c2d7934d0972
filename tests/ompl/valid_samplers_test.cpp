// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ompl/planner_table.h"
#include "ompl/small_problems.h"

#include <map>

namespace mneme::test {
namespace {

/// Mean clearance of 40 states that a sampler draws.
double mean_clearance(const ob::SpaceInformationPtr& information,
                      const ob::ValidStateSamplerAllocator& allocator) {
  const auto sampler = allocator(information.get());
  ob::ScopedState<> state(information);
  double sum = 0;
  for (int i = 0; i < 40; ++i) {
    while (!sampler->sample(state.get())) {
    }
    REQUIRE(information->isValid(state.get()));
    sum += information->getStateValidityChecker()->clearance(state.get());
  }
  return sum / 40;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("each sampler draws valid states, near obstacles or far from them as its name says") {
    const Problem problem = gap_problem();
    const auto information = mneme::ompl::make_space_information(checker_of(problem));
    REQUIRE(valid_sampler_names().size() == 4);
    std::map<std::string, double> clearance;
    for (const std::string& name : valid_sampler_names()) {
      const auto allocator = mneme::ompl::valid_sampler_allocator(name, 0.3);
      REQUIRE_MESSAGE(allocator, name);
      clearance[name] = mean_clearance(information, allocator);
    }
    CHECK(clearance["obstacle_based"] < clearance["max_clearance"]);
    CHECK(clearance["gaussian"] < clearance["max_clearance"]);
    CHECK(clearance["bridge_test"] < clearance["max_clearance"]);
  }

  TEST_CASE("an unknown name has no sampler") {
    CHECK(!mneme::ompl::valid_sampler_allocator("uniform", 0));
  }
}

}  // namespace mneme::test
