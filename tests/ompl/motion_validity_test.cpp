// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ompl/small_problems.h"
#include "ompl/states.h"

namespace mneme::test {
namespace {

constexpr std::uint64_t kMotionSeed = 20263;

struct Motions {
  Problem problem = gap_problem();
  CollisionChecker checker = checker_of(problem);
  std::shared_ptr<mneme::ompl::WorkCounters> counters =
      std::make_shared<mneme::ompl::WorkCounters>();
  ob::SpaceInformationPtr information = mneme::ompl::make_space_information(checker, counters);
  Rng rng{kMotionSeed};

  Configuration free_configuration() {
    for (;;) {
      const Configuration q = random_configuration(problem.robot, rng);
      if (checker.is_valid(q)) return q;
    }
  }
  bool is_valid(const Configuration& from, const Configuration& to) const {
    return information->checkMotion(state_of(information, from).get(),
                                    state_of(information, to).get());
  }
};

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("OMPL's view of a motion is the checker's, and is counted") {
    Motions motions;
    int blocked = 0;
    for (int trial = 0; trial < 100; ++trial) {
      const Configuration from = motions.free_configuration(), to = motions.free_configuration();
      const bool expected = motions.checker.is_motion_valid(from, to);
      CHECK(motions.is_valid(from, to) == expected);
      blocked += expected ? 0 : 1;
    }
    CHECK(blocked > 10);
    CHECK(blocked < 90);
    CHECK(motions.counters->motions.load() == 100);
    CHECK(motions.counters->states.load() > 100);
    CHECK(motions.information->getMotionValidator()->getInvalidMotionCount() ==
          static_cast<unsigned>(blocked));
  }

  TEST_CASE("an obstacle thinner than OMPL's own steps is seen") {
    Motions motions;
    motions.problem.scene = make_circle_scene("", {{2, 0, 0.001}});
    const auto information =
        mneme::ompl::make_space_information(checker_of(motions.problem), motions.counters);
    const auto from = state_of(information, {-0.3, 0, 0}), to = state_of(information, {0.3, 0, 0});
    CHECK(!information->checkMotion(from.get(), to.get()));
  }

  TEST_CASE("a motion to outside the limits is not valid") {
    const Motions motions;
    CHECK(!motions.is_valid({-2, 3, 1}, {-2, 3.2, 1}));
  }
}

TEST_SUITE("law") {
  TEST_CASE(
      "the last valid state of a blocked motion is free, as is the way there; the next is not") {
    Motions motions;
    INFO("seed ", kMotionSeed);
    ob::ScopedState<> last(motions.information);
    int blocked = 0;
    for (int trial = 0; trial < 200; ++trial) {
      const Configuration from = motions.free_configuration(), to = motions.free_configuration();
      std::pair<ob::State*, double> last_valid{last.get(), -1};
      const bool is_valid =
          motions.information->checkMotion(state_of(motions.information, from).get(),
                                           state_of(motions.information, to).get(), last_valid);
      if (is_valid) continue;
      ++blocked;
      REQUIRE(last_valid.second >= 0);
      REQUIRE(last_valid.second < 1);
      const Configuration q = values_of(last.get(), 3);
      CHECK(motions.checker.is_valid(q));
      const Configuration delta = motions.problem.robot.difference(from, to);
      CHECK(motions.problem.robot.distance(from, q) ==
            doctest::Approx(last_valid.second * motions.problem.robot.distance(from, to)));
      const double step = motions.checker.resolution() / motions.problem.robot.distance(from, to);
      Configuration beyond = from;
      for (std::size_t i = 0; i < 3; ++i) {
        beyond[i] += std::min(1.0, last_valid.second + step) * delta[i];
      }
      CHECK(!motions.checker.is_motion_valid(q, beyond));
    }
    CHECK(blocked > 20);
  }

  TEST_CASE("the way to the last valid state is verified where motions are") {
    const Motions motions;
    const auto checker =
        CollisionChecker::make(motions.problem.robot, motions.problem.scene, {.resolution = 4});
    REQUIRE(checker.has_value());
    const MotionVerifier verifier(*checker, Verification::motions);
    const auto validity = mneme::ompl::make_verified_motion_validity(motions.information, *checker,
                                                                     motions.counters, verifier);
    Motions draws;
    ob::ScopedState<> last(motions.information);
    int blocked = 0;
    CheckCounters ignored;
    for (int trial = 0; trial < 200; ++trial) {
      const Configuration from = draws.free_configuration(), to = draws.free_configuration();
      std::pair<ob::State*, double> last_valid{last.get(), -1};
      if (validity->checkMotion(state_of(motions.information, from).get(),
                                state_of(motions.information, to).get(), last_valid)) {
        continue;
      }
      REQUIRE(last_valid.second >= 0);
      if (last_valid.second == 0) continue;
      ++blocked;
      CHECK(verifier.find_invalid_motion({from, values_of(last.get(), 3)}, ignored) == -1);
    }
    CHECK(blocked > 20);
  }
}

}  // namespace mneme::test
