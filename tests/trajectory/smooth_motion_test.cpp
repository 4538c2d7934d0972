// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "trajectory/empty_scene.h"
#include "trajectory/third_order_profile.h"
#include "trajectory/trajectory_flaws.h"

namespace mneme::test {
namespace {

/// The least time of a joint from rest to rest over `length`, in closed form: up to seven segments
/// of constant jerk.
double least_time(double length, double velocity, double acceleration, double jerk) {
  const bool is_steep = velocity * jerk < acceleration * acceleration;
  const double change_s =
      is_steep ? 2 * std::sqrt(velocity / jerk) : velocity / acceleration + acceleration / jerk;
  if (length >= velocity * change_s) return length / velocity + change_s;
  const double ramp_s = acceleration / jerk;
  if (length >= 2 * acceleration * ramp_s * ramp_s) {
    return ramp_s + std::sqrt(ramp_s * ramp_s + 4 * length / acceleration);
  }
  return 4 * std::cbrt(length / (2 * jerk));
}

/// Seconds of the slowest joint by itself, which no motion between both ends beats.
double least_time(const Configuration& from, const Configuration& to, const RateLimits& limits) {
  double most = 0;
  for (std::size_t j = 0; j < from.size(); ++j) {
    most = std::max(most, least_time(std::abs(to[j] - from[j]), limits.velocity[j],
                                     limits.acceleration[j], limits.jerk[j]));
  }
  return most;
}

Trajectory timed(const EmptyScene& empty, const Path& path, const RateLimits& limits, int rounds) {
  TrajectorySettings settings;
  settings.path_tolerance = 10;
  settings.time_rounds = rounds;
  return parameterize(empty.robot(), path, limits, settings, &empty.verifier()).value();
}

}  // namespace

TEST_SUITE("oracle") {
  TEST_CASE("a straight motion of one joint takes the least time of seven segments") {
    const EmptyScene empty(gantry());
    Rng rng(5);
    for (int i = 0; i < 300; ++i) {
      CAPTURE(i);
      const auto any = [&] { return std::pow(10, rng.uniform(-2, 2)); };
      const RateLimits limits{{any(), 1, 1}, {any(), 1, 1}, {any(), 1, 1}};
      const Path path = {{-1, 0, 1}, {-1 + std::pow(10, rng.uniform(-4, 0.3)), 0, 1}};
      const double expected = least_time(path[0], path[1], limits);
      CHECK(timed(empty, path, limits, 0).duration_s() == doctest::Approx(expected).epsilon(1e-7));
      const double tried = timed(empty, path, limits, 4).duration_s();
      CHECK(tried <= expected * (1 + 1e-7));
      CHECK(tried >= expected * (1 - 1e-6));
    }
  }

  TEST_CASE("along its own curve no motion with limited jerk is faster by a fiftieth") {
    const EmptyScene empty(planar8());
    const auto per_joint = [](double first, double second, double third) {
      std::vector<double> limits(8, first);
      limits[1] = second;
      limits[2] = third;
      return limits;
    };
    const RateLimits limits{per_joint(1, 1.5, 2), per_joint(4, 4, 5), per_joint(40, 50, 60)};
    Rng rng(7);
    for (int i = 0; i < 3; ++i) {
      CAPTURE(i);
      const auto q = [&] {
        Configuration state(8, 0.0);
        for (int j = 0; j < 3; ++j) state[static_cast<std::size_t>(j)] = rng.uniform(-1, 1);
        return state;
      };
      const Path path = i == 0 ? Path{q(), q()} : Path{q(), q(), q()};
      const Trajectory motion = timed(empty, path, limits, 0);
      const auto curve = sample_curve(motion, 80);
      const double ratio =
          motion.duration_s() / ThirdOrderProfile(curve, limits, 46, 22).duration();
      MESSAGE("beside brute force: ", ratio);
      CHECK(ratio < 1.02);
      CHECK(ratio > 0.9);
    }
  }

  TEST_CASE("in free space a detour does not matter: the slowest joint decides") {
    const EmptyScene empty(gantry());
    Rng rng(6);
    double worst = 0;
    for (int i = 0; i < 30; ++i) {
      CAPTURE(i);
      const auto q = [&] {
        return Configuration{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(0.5, 1.5)};
      };
      const Path path = {q(), q(), q()};
      const RateLimits limits{{1, 1.5, 2}, {4, 4, 5}, {40, 50, 60}};
      const double ratio =
          timed(empty, path, limits, 100).duration_s() / least_time(path[0], path[2], limits);
      CHECK(ratio > 1 - 1e-6);
      CHECK(ratio < 1.01);
      worst = std::max(worst, ratio);
    }
    MESSAGE("slowest: ", worst);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("legs that a corner joins at speed are passed without a stop") {
    const EmptyScene empty(gantry());
    const RateLimits limits{{1, 1, 1}, {5, 5, 5}, {50, 50, 50}};
    const Trajectory motion = timed(empty, {{-1, 0, 1}, {1, 0, 1}, {1, 1, 1}}, limits, 0);
    // Beside the lengths at 1 m/s, it speeds up and slows down once.
    CHECK(motion.duration_s() == doctest::Approx(3 + 0.2 + 0.1));
    for (double time_s = 0.3; time_s < 3; time_s += 0.01) {
      CHECK(largest(motion.at(time_s).velocity) > 0.49);
    }
  }
}

}  // namespace mneme::test
