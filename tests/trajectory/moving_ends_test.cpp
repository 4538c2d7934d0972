// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/small_worlds.h"
#include "trajectory/empty_scene.h"
#include "trajectory/trajectory_flaws.h"

namespace mneme::test {
namespace {

const RateLimits kTwos = {{2, 2, 2}, {4, 4, 4}, {40, 40, 40}};

Result<Trajectory> timed_from(const EmptyScene& empty, const Path& path,
                              const std::vector<double>& velocity, const RateLimits& limits,
                              int rounds = 8, const std::vector<double>& end_velocity = {}) {
  TrajectorySettings settings;
  settings.time_rounds = rounds;
  return parameterize(empty.robot(), path, limits, settings, &empty.verifier(), velocity,
                      end_velocity);
}

std::string refusal(const Path& path, const std::vector<double>& velocity) {
  const EmptyScene empty(gantry());
  return require_error(timed_from(empty, path, velocity, kTwos)).message;
}

std::string refusal_of_end(const Path& path, const std::vector<double>& velocity,
                           const std::vector<double>& end_velocity) {
  const EmptyScene empty(gantry());
  return require_error(timed_from(empty, path, velocity, kTwos, 8, end_velocity)).message;
}

std::vector<double> negative(std::vector<double> v) {
  for (double& value : v) value = -value;
  return v;
}

/// Share `share` of the greatest velocity along a random direction.
std::vector<double> random_velocity(const RateLimits& limits, double share, Rng& rng) {
  std::vector<double> velocity;
  for (const double most : limits.velocity) velocity.push_back(share * most * rng.uniform(-1, 1));
  return velocity;
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("a motion begins with the start velocity, keeps all limits and ends at rest") {
    const EmptyScene empty(planar8());
    Rng rng(3);
    int count = 0;
    for (int i = 0; i < 60; ++i) {
      CAPTURE(i);
      Path path = random_path(empty.robot(), rng);
      RateLimits limits =
          i % 2 == 0 ? random_limits(empty.robot(), rng) : random_jerk_limits(empty.robot(), rng);
      const auto velocity = random_velocity(limits, std::pow(10, rng.uniform(-3, 0)), rng);
      const auto stop = stopping_point(empty.robot(), path.front(), velocity, limits);
      if (!stop) continue;                  // beyond a joint's range
      if (*stop == path.front()) continue;  // at rest
      ++count;
      path.insert(path.begin() + 1, empty.robot().normalized(*stop));
      const auto motion = require(timed_from(empty, path, velocity, limits));
      for (std::size_t j = 0; j < velocity.size(); ++j) {
        CHECK(motion.at(0).velocity[j] ==
              doctest::Approx(velocity[j]).epsilon(1e-5).scale(limits.velocity[j]));
      }
      CHECK(largest(motion.at(motion.duration_s()).velocity) == 0);
      const auto flaw = trajectory_flaw(empty.robot(), path, limits, 1, motion, velocity);
      CHECK_MESSAGE(!flaw, flaw.value_or(""));
    }
    CHECK(count > 20);
  }

  TEST_CASE("a motion with velocities at both ends has them, and keeps all limits") {
    const EmptyScene empty(planar8());
    Rng rng(5);
    int count = 0;
    for (int i = 0; i < 60; ++i) {
      CAPTURE(i);
      const Robot& robot = empty.robot();
      Path path = random_path(robot, rng);
      const RateLimits limits =
          i % 2 == 0 ? random_limits(robot, rng) : random_jerk_limits(robot, rng);
      const auto end = random_velocity(limits, std::pow(10, rng.uniform(-3, 0)), rng);
      const auto run_up = run_up_point(robot, path.back(), end, limits);
      if (!run_up || *run_up == path.back()) continue;
      path.insert(path.end() - 1, robot.normalized(*run_up));
      std::vector<double> begin;
      if (i % 3 > 0) {
        begin = random_velocity(limits, std::pow(10, rng.uniform(-3, 0)), rng);
        const auto stop = stopping_point(robot, path.front(), begin, limits);
        if (!stop) continue;
        path.insert(path.begin() + 1, robot.normalized(*stop));
      }
      ++count;
      const auto motion = require(timed_from(empty, path, begin, limits, 8, end));
      for (std::size_t j = 0; j < end.size(); ++j) {
        CHECK(motion.at(motion.duration_s()).velocity[j] ==
              doctest::Approx(end[j]).epsilon(1e-5).scale(limits.velocity[j]));
      }
      const auto flaw = trajectory_flaw(robot, path, limits, 1, motion, begin);
      CHECK_MESSAGE(!flaw, flaw.value_or(""));
    }
    CHECK(count > 20);
  }

  TEST_CASE("a motion that ends with a velocity takes as long as the one back in time") {
    const EmptyScene empty(planar8());
    Rng rng(7);
    int count = 0;
    for (int i = 0; i < 60; ++i) {
      CAPTURE(i);
      Path path = random_path(empty.robot(), rng);
      const RateLimits limits =
          i % 2 == 0 ? random_limits(empty.robot(), rng) : random_jerk_limits(empty.robot(), rng);
      const auto velocity = random_velocity(limits, std::pow(10, rng.uniform(-2, 0)), rng);
      const auto stop = stopping_point(empty.robot(), path.front(), velocity, limits);
      if (!stop || *stop == path.front()) continue;
      ++count;
      CHECK(*stop == run_up_point(empty.robot(), path.front(), negative(velocity), limits).value());
      path.insert(path.begin() + 1, empty.robot().normalized(*stop));
      const auto forth = timed_from(empty, path, velocity, limits, 0);
      const auto back =
          timed_from(empty, {path.rbegin(), path.rend()}, {}, limits, 0, negative(velocity));
      REQUIRE_MESSAGE(back.has_value(), (back ? "" : back.error().message));
      CHECK(back->duration_s() == doctest::Approx(forth->duration_s()).epsilon(1e-4));
    }
    CHECK(count > 20);
  }

  TEST_CASE("a start velocity towards the goal makes the motion shorter") {
    const EmptyScene empty(gantry());
    const Path path = {{-1, 0, 1}, {1, 0, 1}};
    double last = timed_from(empty, path, {}, kTwos)->duration_s();
    for (const double speed : {0.5, 1.0, 2.0}) {
      const double duration_s = timed_from(empty, path, {speed, 0, 0}, kTwos)->duration_s();
      CHECK(duration_s < last);
      last = duration_s;
    }
  }
}

TEST_SUITE("unit") {
  TEST_CASE("the stopping point is the closed form of a stop with limited jerk") {
    // From 2 m/s at 4 m/s^2 and 40 m/s^3: 2 / 4 + 4 / 40 seconds at half of the speed.
    CHECK(contains(require_error(stopping_point(gantry(), {0, 0, 0, 0}, {2, 0, 0}, kTwos)).message,
                   "expected 3 joint values"));
    const auto stop = require(stopping_point(gantry(), {-1, 0, 1}, {2, 0, 0}, kTwos));
    CHECK(stop[0] == doctest::Approx(-1 + 0.6).epsilon(1e-6));
    CHECK(stop[1] == 0);
    CHECK(stopping_point(gantry(), {-1, 0, 1}, {0, 0, 0}, kTwos).value() ==
          Configuration{-1, 0, 1});
  }

  TEST_CASE("a motion goes on past its stopping point at speed where it may") {
    const EmptyScene empty(gantry());
    const Path path = {{-1, 0, 1}, {-0.4, 0, 1}, {-0.4, 1, 1}};
    const double duration_s = timed_from(empty, path, {2, 0, 0}, kTwos, 0)->duration_s();
    const double stop_s = 0.6,
                 rest_s = timed_from(empty, {path[1], path[2]}, {}, kTwos, 0)->duration_s();
    CHECK(duration_s < 0.95 * (stop_s + rest_s));
  }

  TEST_CASE("a motion that only stops decelerates from its first moment on") {
    const EmptyScene empty(gantry());
    const RateLimits without_jerk{{2, 2, 2}, {4, 4, 4}};
    for (const RateLimits& limits : {kTwos, without_jerk}) {
      const Configuration start = {-1, 0, 1};
      const auto stop = require(stopping_point(empty.robot(), start, {1.9, 0, 0}, limits));
      for (const Path& path : {Path{start, stop}, Path{start, stop, {-1, 1, 1}}}) {
        const auto motion = require(timed_from(empty, path, {1.9, 0, 0}, limits));
        const bool jumps = limits.jerk.empty();
        CHECK(motion.at(0).acceleration[0] == doctest::Approx(jumps ? -4 : 0).epsilon(1e-6));
        for (const double time_s : {1e-9, 1e-8, 1e-7, 1e-6}) {
          CHECK(motion.at(time_s).acceleration[0] < 0);
        }
      }
    }
  }

  TEST_CASE("velocities whose stop is shorter than two micrometres count as rest") {
    const EmptyScene empty(gantry());
    const RateLimits ones{{1, 1, 1}, {1, 1, 1}};
    const Path path = {{-1, 0, 1}, {0, 1, 1}};
    const double rest_s = timed_from(empty, path, {}, ones)->duration_s();
    for (const double speed : {1e-12, 1e-6, 1e-3}) {
      CHECK(stopping_point(gantry(), path[0], {0, speed, 0}, ones).value() == path[0]);
      CHECK(require(timed_from(empty, path, {0, speed, 0}, ones)).duration_s() == rest_s);
    }
  }

  TEST_CASE("start velocities that cannot be met are refused with the reason") {
    const Path path = {{-1, 0, 1}, {1, 0, 1}};
    CHECK(refusal(path, {3, 0, 0}) == "start velocity: joint '" + gantry().group_joint(0).name +
                                          "' moves at 3, faster than its limit 2");
    CHECK(refusal(path, {1}).starts_with("start velocity: got 1 values, expected 3"));
    CHECK(refusal(path, {1, 1, 0})
              .starts_with("start velocity: expected it along the path's first motion"));
    CHECK(refusal(path, {-1, 0, 0})
              .starts_with("start velocity: expected it along the path's first motion"));
    CHECK(
        refusal({{-1, 0, 1}, {-0.9, 0, 1}}, {2, 0, 0}) ==
        "start velocity: a stop takes 0.6 (L2 joint distance), and the path's first motion is 0.1 "
        "long");
    CHECK(refusal({{-1, 0, 1}}, {1, 0, 0}).starts_with("start velocity: the path does not move"));
    CHECK(refusal(path, {std::nan(""), 0, 0}).starts_with("start velocity: joint"));
    CHECK(refusal_of_end(path, {}, {-1, 0, 0})
              .starts_with("end velocity: expected it along the path's last motion"));
    CHECK(refusal_of_end({{-1, 0, 1}, {-0.9, 0, 1}}, {}, {2, 0, 0}) ==
          "end velocity: a run-up takes 0.6 (L2 joint distance), and the path's last motion is "
          "0.1 long");
    CHECK(refusal_of_end({{-1, 0, 1}, {0, 0, 1}}, {2, 0, 0}, {2, 0, 0}) ==
          "start and end velocity: a stop and a run-up take 1.2 (L2 joint distance), and the path "
          "is 1 long");
    const Robot robot = gantry();
    const Joint& joint = robot.group_joint(0);
    const Error error =
        require_error(stopping_point(robot, {joint.upper - 0.1, 0, 1}, {2, 0, 0}, kTwos));
    CHECK(error.message.starts_with("start velocity: joint '" + joint.name + "' would stop at "));
    const Error before =
        require_error(run_up_point(robot, {joint.upper - 0.1, 0, 1}, {-2, 0, 0}, kTwos));
    CHECK(before.message.starts_with("end velocity: joint '" + joint.name +
                                     "' would have to start at "));
  }
}

}  // namespace mneme::test
