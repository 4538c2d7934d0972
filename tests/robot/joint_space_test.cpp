// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/joint_space.h"
#include "robot/small_robots.h"

#include <array>
#include <cmath>
#include <vector>

namespace mneme::test {
namespace {

/// A continuous, a revolute and a prismatic joint.
Robot mixed_robot() {
  Robot::Parts parts = make_chain(3);
  parts.joints[0].type = JointType::continuous;
  parts.joints[2].type = JointType::prismatic;
  parts.joints[2].lower = 0.25;
  parts.joints[2].upper = 1.5;
  return require_robot(parts);
}

float to_limits(const internal::JointSpace& space, int joint, double value) {
  return space.into_limits(joint, static_cast<float>(value));
}

TEST_SUITE("unit") {
  TEST_CASE("limits in single precision lie within those in double precision, and next to them") {
    for (const double limit : {0.38615, 0.1, kPi, 1.6056, 2e-5, 0.5}) {
      Robot::Parts parts = make_chain(1);
      parts.joints[0].lower = -limit;
      parts.joints[0].upper = limit;
      const internal::JointSpace space(require_robot(parts));
      CHECK(static_cast<double>(space.upper(0)) <= limit);
      CHECK(static_cast<double>(space.lower(0)) >= -limit);
      CHECK(space.upper(0) == doctest::Approx(limit).epsilon(1e-6));
      CHECK(space.into_limits(0, 9) == space.upper(0));
      CHECK(space.into_limits(0, -9) == space.lower(0));
    }
  }

  TEST_CASE("a joint that its limits lock has one value, which is next to them") {
    for (const double value : {0.1, -0.1, 0.5, 1.6056}) {
      Robot::Parts parts = make_chain(1);
      parts.joints[0].lower = parts.joints[0].upper = value;
      const internal::JointSpace space(require_robot(parts));
      CHECK(space.lower(0) == space.upper(0));
      CHECK(space.upper(0) == doctest::Approx(value).epsilon(1e-6));
      for (const float other : {-9.0f, space.upper(0), 9.0f}) {
        CHECK(space.into_limits(0, other) == space.upper(0));
      }
    }
  }

  TEST_CASE("limits and periods are those of the group, in its order") {
    const internal::JointSpace space(mixed_robot());
    REQUIRE(space.joint_count() == 3);
    CHECK(space.lower(0) == doctest::Approx(-kPi));
    CHECK(space.upper(0) == doctest::Approx(kPi));
    CHECK(space.lower(1) == -2.0f);
    CHECK(space.upper(1) == 2.0f);
    CHECK(space.lower(2) == 0.25f);
    CHECK(space.upper(2) == 1.5f);
    REQUIRE(space.periods().size() == 3);
    CHECK(space.periods()[0] == static_cast<float>(2 * kPi));
    CHECK(space.periods()[1] == 0.0f);
    CHECK(space.periods()[2] == 0.0f);

    Robot::Parts parts = make_chain(2);
    parts.joints[1].lower = -1;
    const internal::JointSpace reversed(require_robot(parts, test::plan_for({"j2", "j1"})));
    CHECK(reversed.lower(0) == -1.0f);
    CHECK(reversed.lower(1) == -2.0f);
  }

  TEST_CASE("a continuous joint wraps and the others stop at their limits") {
    const internal::JointSpace space(mixed_robot());
    CHECK(to_limits(space, 0, 1.25) == 1.25f);
    CHECK(to_limits(space, 0, 4) == doctest::Approx(4 - 2 * kPi));
    CHECK(to_limits(space, 0, -4) == doctest::Approx(2 * kPi - 4));
    CHECK(to_limits(space, 0, 100) == doctest::Approx(std::remainder(100, 2 * kPi)));
    CHECK(to_limits(space, 1, 1.25) == 1.25f);
    CHECK(to_limits(space, 1, 4) == 2.0f);
    CHECK(to_limits(space, 1, -4) == -2.0f);
    CHECK(to_limits(space, 2, 0) == 0.25f);
    CHECK(to_limits(space, 2, INFINITY) == 1.5f);
  }

  TEST_CASE("a displacement takes the shorter way round for continuous joints only") {
    const internal::JointSpace space(mixed_robot());
    const std::array a = {3.0f, 2.0f, 0.5f}, b = {-3.0f, -2.0f, 1.0f};
    std::array<float, 3> delta{};
    const float length = space.difference(a.data(), b.data(), delta.data());
    CHECK(delta[0] == doctest::Approx(2 * kPi - 6));
    CHECK(delta[1] == -4.0f);
    CHECK(delta[2] == 0.5f);
    CHECK(length == doctest::Approx(std::hypot(2 * kPi - 6, 4, 0.5)));
    CHECK(space.difference(a.data(), a.data(), delta.data()) == 0.0f);
  }

  TEST_CASE("a displacement of several turns is that of its remainder") {
    const internal::JointSpace space(mixed_robot());
    const std::array a = {0.0f, 0.0f, 1.0f}, b = {static_cast<float>(6 * kPi + 0.5), 0.0f, 1.0f};
    std::array<float, 3> delta{};
    CHECK(space.difference(a.data(), b.data(), delta.data()) == doctest::Approx(0.5).epsilon(1e-5));
  }
}

TEST_SUITE("law") {
  TEST_CASE("single precision agrees with the robot's own limits and differences") {
    const Robot robot = mixed_robot();
    const internal::JointSpace space(robot);
    Rng rng(601);
    for (int i = 0; i < 20000; ++i) {
      std::array<float, 3> a{}, b{}, delta{};
      for (std::size_t j = 0; j < 3; ++j) {
        a[j] = static_cast<float>(rng.uniform(-9.0, 9.0));
        b[j] = static_cast<float>(rng.uniform(-9.0, 9.0));
      }
      const Configuration exact_a(a.begin(), a.end()), exact_b(b.begin(), b.end());
      const float length = space.difference(a.data(), b.data(), delta.data());
      INFO("seed 601, case " << i);
      REQUIRE(std::abs(length - robot.distance(exact_a, exact_b)) < 1e-5);
      const Configuration limited = robot.normalized(exact_a);
      for (int j = 0; j < 3; ++j) {
        const auto k = static_cast<std::size_t>(j);
        const double error = space.into_limits(j, a[k]) - limited[k];
        // Half a turn may come out on either side.
        REQUIRE(std::abs(j == 0 ? std::remainder(error, 2 * kPi) : error) < 2e-6);
        // The joint arrives at `b`, give or take whole turns.
        const double missed = exact_a[k] + delta[k] - exact_b[k];
        REQUIRE(std::abs(j == 0 ? std::remainder(missed, 2 * kPi) : missed) < 5e-6);
      }
    }
  }

  TEST_CASE("whatever comes in, what comes out is a configuration of the robot") {
    const Robot robot = mixed_robot();
    const internal::JointSpace space(robot);
    Rng rng(602);
    for (int i = 0; i < 20000; ++i) {
      Configuration q;
      for (int j = 0; j < 3; ++j) {
        // Half turns and their neighbours are where wrapping may go wrong.
        float value = i % 4 == 0 ? static_cast<float>((static_cast<int>(rng.index(9)) - 4) * kPi)
                                 : static_cast<float>(rng.uniform(-20.0, 20.0));
        if (i % 8 == 0) value = std::nextafter(value, i % 16 == 0 ? 100.0f : -100.0f);
        q.push_back(space.into_limits(j, value));
        // Again changes nothing, but for half a turn that rounding put on the other side.
        const double change = space.into_limits(j, static_cast<float>(q.back())) - q.back();
        REQUIRE(std::abs(j == 0 ? std::remainder(change, 2 * kPi) : change) < 1e-6);
      }
      REQUIRE(!robot.describe_violation(q, "sample"));
      REQUIRE(std::abs(q[0]) < kPi + 3e-6);
    }
  }

  TEST_CASE("there and back are as long, and opposite") {
    const internal::JointSpace space(mixed_robot());
    Rng rng(603);
    for (int i = 0; i < 5000; ++i) {
      std::array<float, 3> a{}, b{}, there{}, back{};
      for (std::size_t j = 0; j < 3; ++j) {
        a[j] = static_cast<float>(rng.uniform(-3.0, 3.0));
        b[j] = static_cast<float>(rng.uniform(-3.0, 3.0));
      }
      REQUIRE(space.difference(a.data(), b.data(), there.data()) ==
              space.difference(b.data(), a.data(), back.data()));
      REQUIRE(std::abs(there[0]) < kPi + 1e-6);
      for (std::size_t j = 0; j < 3; ++j) REQUIRE(there[j] == -back[j]);
    }
  }
}

}  // namespace
}  // namespace mneme::test
