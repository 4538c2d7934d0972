// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ompl/small_problems.h"

namespace mneme::test {
namespace {

constexpr std::uint64_t kSpaceSeed = 20261;

struct TwoStates {
  Robot robot = planar8();
  std::shared_ptr<mneme::ompl::JointStateSpace> space =
      std::make_shared<mneme::ompl::JointStateSpace>(robot);
  ob::ScopedState<> a{space}, b{space}, c{space};
  void set(const Configuration& first, const Configuration& second) {
    set_values(a.get(), first);
    set_values(b.get(), second);
  }
};

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("dimensions carry the names and limits of the joints") {
    const TwoStates states;
    const auto& space = *states.space;
    REQUIRE(space.getDimension() == 8);
    for (int i = 0; i < 8; ++i) {
      const Joint& joint = states.robot.group_joint(i);
      CHECK(space.getDimensionName(static_cast<unsigned>(i)) == joint.name);
      CHECK(space.getBounds().low[static_cast<std::size_t>(i)] == joint.lower);
      CHECK(space.getBounds().high[static_cast<std::size_t>(i)] == joint.upper);
    }
  }

  TEST_CASE("states that are held are counted") {
    const TwoStates states;
    const std::uint64_t before = states.space->state_count();
    ob::State* state = states.space->allocState();
    CHECK(states.space->state_count() == before + 1);
    states.space->freeState(state);
    CHECK(states.space->state_count() == before);
  }

  TEST_CASE("a state outside the limits is wrapped where the joint turns, and clamped elsewhere") {
    TwoStates states;
    states.set({4, 4, -4, 0, 0, 0, 0, 0}, Configuration(8, 0.0));
    CHECK(!states.space->satisfiesBounds(states.a.get()));
    states.space->enforceBounds(states.a.get());
    const Configuration q = values_of(states.a.get(), 8);
    CHECK(q[0] == doctest::Approx(4 - 2 * kPi));
    CHECK(q[1] == doctest::Approx(kPi));
    CHECK(q[2] == doctest::Approx(-kPi));
    CHECK(states.space->satisfiesBounds(states.a.get()));
  }

  TEST_CASE("states that differ by a turn of a continuous joint are equal, others are not") {
    TwoStates states;
    states.set({-kPi, 1, 0, 0, 0, 0, 0, 0}, {kPi, 1, 0, 0, 0, 0, 0, 0});
    CHECK(states.space->equalStates(states.a.get(), states.b.get()));
    states.set({0, -kPi, 0, 0, 0, 0, 0, 0}, {0, kPi, 0, 0, 0, 0, 0, 0});
    CHECK(!states.space->equalStates(states.a.get(), states.b.get()));
  }
}

TEST_SUITE("law") {
  TEST_CASE("distance and interpolation are those of the robot") {
    TwoStates states;
    Rng rng(kSpaceSeed);
    for (int trial = 0; trial < 200; ++trial) {
      const Configuration from = random_configuration(states.robot, rng);
      const Configuration to = random_configuration(states.robot, rng);
      states.set(from, to);
      const double distance = states.robot.distance(from, to);
      CHECK(states.space->distance(states.a.get(), states.b.get()) == doctest::Approx(distance));
      CHECK(distance <= states.space->getMaximumExtent());
      const double t = rng.uniform();
      states.space->interpolate(states.a.get(), states.b.get(), t, states.c.get());
      CHECK(states.space->satisfiesBounds(states.c.get()));
      const Configuration between = values_of(states.c.get(), 8);
      CHECK(states.robot.distance(from, between) == doctest::Approx(t * distance).epsilon(1e-9));
      CHECK(states.robot.distance(between, to) ==
            doctest::Approx((1 - t) * distance).epsilon(1e-9));
    }
  }

  TEST_CASE("OMPL's own checks of a state space pass") {
    TwoStates states;
    states.space->setup();
    CHECK_NOTHROW(states.space->sanityChecks());
  }

  TEST_CASE("samples near a state go on beyond the seam of a continuous joint, within limits") {
    TwoStates states;
    states.set({kPi - 0.05, kPi - 0.05, 0, 0, 0, 0, 0, 0}, Configuration(8, 0.0));
    const auto sampler = states.space->allocDefaultStateSampler();
    int beyond_near = 0, beyond_bell = 0;
    const auto check = [&](double reach) {
      const Configuration q = values_of(states.b.get(), 8);
      CHECK(states.space->satisfiesBounds(states.b.get()));
      CHECK(std::abs(std::remainder(q[0] - (kPi - 0.05), 2 * kPi)) <= reach);
      return q[0] < 0 ? 1 : 0;
    };
    for (int i = 0; i < 200; ++i) {
      sampler->sampleUniformNear(states.b.get(), states.a.get(), 0.2);
      beyond_near += check(0.2);
      sampler->sampleGaussian(states.b.get(), states.a.get(), 0.1);
      beyond_bell += check(0.6);
    }
    CHECK(beyond_near > 40);
    CHECK(beyond_bell > 40);
  }
}

}  // namespace mneme::test
