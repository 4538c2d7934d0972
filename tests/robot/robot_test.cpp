// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/small_robots.h"
#include "support/support.h"

#include <cmath>
#include <limits>
#include <vector>

namespace mneme {
namespace {

using test::contains;
using test::kPi;

double norm(const Configuration& v) {
  double sum = 0;
  for (const double x : v) sum += x * x;
  return std::sqrt(sum);
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a configuration of wrong length is refused with both counts") {
    const Robot robot = test::require_robot(test::make_chain(3));
    const std::vector<double> q{0, 0};
    const std::string why = robot.describe_violation(q, "start").value();
    CHECK(contains(why, "start: there are 2 values"));
    CHECK(contains(why, "3 joints"));
  }

  TEST_CASE("a value that is no number is refused by joint") {
    const Robot robot = test::require_robot(test::make_chain(2));
    const std::vector<double> q{0, std::nan("")};
    CHECK(contains(robot.describe_violation(q, "goal").value(), "goal: joint 'j2'"));
    const std::vector<double> infinite{std::numeric_limits<double>::infinity(), 0};
    CHECK(contains(robot.describe_violation(infinite, "goal").value(), "goal: joint 'j1'"));
  }

  TEST_CASE("a value beyond its limit by more than 1e-5 is refused with the limits") {
    const Robot robot = test::require_robot(test::make_chain(2));
    CHECK_FALSE(robot.describe_violation(std::vector<double>{2 + 0.9e-5, -2 - 0.9e-5}, "start"));
    const std::vector<double> q{0, -2 - 1.1e-5};
    CHECK(contains(robot.describe_violation(q, "start").value(), "outside its limits [-2, 2]"));
  }

  TEST_CASE("a continuous joint may have any angle") {
    const Robot robot = test::require_robot(test::make_chain(1, JointType::continuous));
    CHECK_FALSE(robot.describe_violation(std::vector<double>{100.0}, "start"));
  }

  TEST_CASE("normalizing wraps continuous joints to [-pi, pi) and clamps others") {
    const Robot arm = test::planar8();
    Configuration q(8, 3.5);
    q[0] = kPi;
    q[7] = -4;
    const Configuration normal = arm.normalized(q);
    CHECK(normal[0] == -kPi);
    CHECK(normal[1] == kPi);
    CHECK(normal[7] == -kPi);
    q[0] = 7;
    CHECK(arm.normalized(q)[0] == doctest::Approx(7 - 2 * kPi).epsilon(1e-14));
  }

  TEST_CASE("only the continuous joint takes the shorter way round") {
    const Robot arm = test::planar8();
    Configuration a(8, 0.0), b(8, 0.0);
    a[0] = a[1] = 3;
    b[0] = b[1] = -3;
    const Configuration step = arm.difference(a, b);
    CHECK(step[0] == doctest::Approx(2 * kPi - 6));
    CHECK(step[1] == -6);
    CHECK(arm.distance(a, b) == doctest::Approx(std::hypot(2 * kPi - 6, 6)));
  }
}

TEST_SUITE("law") {
  TEST_CASE("differences are antisymmetric and lead from one configuration to the other") {
    const Robot arm = test::planar8();
    Rng rng(21);
    for (int repetition = 0; repetition < 500; ++repetition) {
      const Configuration a = test::random_configuration(arm, rng);
      const Configuration b = test::random_configuration(arm, rng);
      const Configuration there = arm.difference(a, b), back = arm.difference(b, a);
      Configuration end = a;
      for (std::size_t i = 0; i < a.size(); ++i) {
        CHECK(there[i] == -back[i]);
        end[i] += there[i];
      }
      CHECK(std::abs(there[0]) <= kPi);
      CHECK(arm.distance(end, b) < 1e-14);
    }
  }

  TEST_CASE("distance is a metric and the norm of the difference") {
    const Robot arm = test::planar8();
    Rng rng(22);
    for (int repetition = 0; repetition < 500; ++repetition) {
      const Configuration a = test::random_configuration(arm, rng);
      const Configuration b = test::random_configuration(arm, rng);
      const Configuration c = test::random_configuration(arm, rng);
      CHECK(arm.distance(a, a) == 0);
      CHECK(arm.distance(a, b) > 0);
      CHECK(arm.distance(a, b) == arm.distance(b, a));
      CHECK(arm.distance(a, c) <= arm.distance(a, b) + arm.distance(b, c) + 1e-12);
      CHECK(arm.distance(a, b) == doctest::Approx(norm(arm.difference(a, b))).epsilon(1e-14));
    }
  }

  TEST_CASE("normalizing changes nothing twice, nor the pose of any link") {
    const Robot arm = test::planar8();
    Rng rng(23);
    for (int repetition = 0; repetition < 100; ++repetition) {
      Configuration q = test::random_configuration(arm, rng);
      q[0] = rng.uniform(-50, 50);
      const Configuration normal = arm.normalized(q);
      CHECK(arm.normalized(normal) == normal);
      CHECK((normal[0] >= -kPi && normal[0] < kPi));
      CHECK_FALSE(arm.describe_violation(normal, "q"));
      const Vec3 tip = arm.link_poses(q).back().translation;
      CHECK((arm.link_poses(normal).back().translation - tip).norm() < 1e-12);
    }
  }
}

}  // namespace mneme
