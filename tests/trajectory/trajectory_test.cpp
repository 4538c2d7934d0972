// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/trajectory.h"

#include "planning/small_worlds.h"
#include "robot/small_robots.h"
#include "trajectory/empty_scene.h"
#include "trajectory/trajectory_flaws.h"

#include <array>

namespace mneme::test {
namespace {

Trajectory require_timed(const EmptyScene& empty, const Path& path, const RateLimits& limits,
                         double tolerance = 0.1, int rounds = 0) {
  TrajectorySettings settings;
  settings.path_tolerance = tolerance;
  settings.time_rounds = rounds;
  return require(parameterize(empty.robot(), path, limits, settings, &empty.verifier()));
}

const Path kTurn = {{-1, 0, 1}, {1, 0, 1}, {1, 1, 1}};
const RateLimits kOnes = {{1, 1, 1}, {1, 1, 1}};

std::string refusal(const Path& path, const RateLimits& limits, double tolerance = 0.1) {
  TrajectorySettings settings;
  settings.path_tolerance = tolerance;
  const Error error = require_error(parameterize(gantry(), path, limits, settings, nullptr));
  CHECK(error.code == ErrorCode::invalid);
  return error.message;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a rounded corner is faster than a stop, and a wider one faster still") {
    const EmptyScene empty(gantry());
    const double stop = require_timed(empty, kTurn, kOnes, 0).duration_s();
    const double tight = require_timed(empty, kTurn, kOnes, 0.01).duration_s();
    const double wide = require_timed(empty, kTurn, kOnes, 0.1).duration_s();
    CHECK(stop == doctest::Approx(3 + 2));
    CHECK(tight < stop - 0.05);
    CHECK(wide < tight - 0.1);
  }

  TEST_CASE("samples lie dt apart and end at rest where the path ends") {
    const EmptyScene empty(gantry());
    const Trajectory motion = require_timed(empty, kTurn, kOnes);
    const auto points = motion.sample(0.01).value();
    REQUIRE(points.size() > 2);
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      CHECK(points[i].time_s == doctest::Approx(0.01 * static_cast<double>(i)));
    }
    const Trajectory::Point &first = points.front(), &last = points.back();
    CHECK(last.time_s == motion.duration_s());
    CHECK(last.time_s - points[points.size() - 2].time_s <= 0.015 * (1 + 1e-9));
    CHECK(first.position == kTurn.front());
    CHECK(first.velocity == Configuration(3, 0.0));
    CHECK(largest(first.acceleration) > 0.9);
    CHECK(distance_to({kTurn.back()}, last.position) < 1e-12);
    CHECK(last.velocity == Configuration(3, 0.0));
    CHECK(last.acceleration == Configuration(3, 0.0));
  }

  TEST_CASE("steps that fit into the duration do not leave one of length 0") {
    const EmptyScene empty(gantry());
    const Trajectory motion = require_timed(empty, {{0, 0, 0}, {1, 0, 0}}, kOnes);
    CHECK(motion.duration_s() == doctest::Approx(2));
    CHECK(motion.sample(0.1).value().size() == 21);
    CHECK(motion.sample(1000).value().size() == 2);
  }

  TEST_CASE("the last step takes at least half of dt, and durations are whole nanoseconds") {
    const EmptyScene empty(gantry());
    for (const double reach : {1.0, 0.0625, 0.333, 0.7071, 1e-5}) {
      const Trajectory motion = require_timed(empty, {{0, 0, 0}, {reach, 0, 0}}, kOnes);
      CAPTURE(reach);
      const double nanoseconds = motion.duration_s() * 1e9;
      CHECK(std::abs(nanoseconds - std::round(nanoseconds)) < 1e-5);
      for (const double dt : {1e-4, 1e-3, 0.0173, 0.01}) {
        const auto points = motion.sample(dt).value();
        REQUIRE(points.size() >= 2);
        const double last_s = points.back().time_s - points[points.size() - 2].time_s;
        CHECK(last_s > std::min(0.4999 * dt, 0.9999 * motion.duration_s()));
        CHECK(last_s < std::max(1.5001 * dt, 1.0001 * motion.duration_s()));
        CHECK(points.back().position[0] == doctest::Approx(reach));
        CHECK(points.back().velocity == Configuration(3, 0.0));
      }
    }
  }

  TEST_CASE("a trajectory begins at the turn of its path, however many turns that is") {
    const EmptyScene empty(thick_arm({1, 1}));
    const RateLimits limits{{1, 1}, {1, 1}};
    const Path once = {{3, 0}, {-3, 0.5}, {-2.5, 0}};
    Path thrice = once;
    thrice.front()[0] += 6 * kPi;
    const Trajectory near = require_timed(empty, once, limits);
    const Trajectory far = require_timed(empty, thrice, limits);
    CHECK(far.duration_s() == near.duration_s());
    CHECK(far.at(0).position == thrice.front());
    for (double time_s = 0; time_s < near.duration_s() + 0.1; time_s += 0.1) {
      const double offset = far.at(time_s).position[0] - near.at(time_s).position[0];
      CHECK(offset == doctest::Approx(6 * kPi).epsilon(1e-12));
    }
    CHECK(near.at(near.duration_s()).position[0] == doctest::Approx(2 * kPi - 2.5));
  }

  TEST_CASE("with a limit of jerk acceleration grows from 0, also after a stop") {
    const EmptyScene empty(gantry());
    RateLimits limits = kOnes;
    limits.jerk = {4, INFINITY, 100};
    const Trajectory motion = require_timed(empty, kTurn, limits, 0);
    // 2 m and 1 m at 1 m/s: distance / speed + speed / acceleration + acceleration / jerk.
    CHECK(motion.duration_s() == doctest::Approx(2 + 1 + 0.25 + 1 + 1));
    CHECK(motion.at(0).position == kTurn.front());
    CHECK(largest(motion.at(0).acceleration) == 0);
    CHECK(motion.at(0.125).acceleration[0] == doctest::Approx(0.5));
    CHECK(motion.at(0.125).velocity[0] == doctest::Approx(4 * 0.125 * 0.125 / 2));
    CHECK(motion.at(0.125).position[0] == doctest::Approx(-1 + 4 * 0.125 * 0.125 * 0.125 / 6));
    CHECK(distance_to({kTurn[1]}, motion.at(3.25).position) < 1e-6);
    CHECK(distance_to({kTurn[2]}, motion.at(5.25).position) < 1e-12);
    limits.jerk = {};
    CHECK(require_timed(empty, kTurn, limits, 0).duration_s() == doctest::Approx(5));
  }

  TEST_CASE("rounds make a motion faster, and none leaves it along its path") {
    const EmptyScene empty(gantry());
    RateLimits limits = kOnes;
    for (const double jerk : {4.0, double{INFINITY}}) {
      limits.jerk = {jerk, jerk, jerk};
      double last = INFINITY;
      for (const int rounds : {0, 2, 8, 40}) {
        const Trajectory motion = require_timed(empty, kTurn, limits, 1, rounds);
        CHECK(motion.duration_s() <= 1.001 * last);  // barriers end within a percent
        CHECK(motion.at(0).position == kTurn.front());
        last = motion.duration_s();
        const auto flaw = trajectory_flaw(empty.robot(), kTurn, limits, 1, motion);
        CHECK_MESSAGE(!flaw, flaw.value_or(""));
      }
      CHECK(last < 0.9 * require_timed(empty, kTurn, limits, 1).duration_s());
    }
  }

  TEST_CASE("rounds make a motion faster, however near to its corner a post is") {
    for (const double jerk : {40.0, double{INFINITY}}) {
      CAPTURE(jerk);
      const RateLimits limits{{2, 2, 2}, {4, 4, 4}, {jerk, jerk, jerk}};
      for (int i = 0; i < 60; ++i) {
        const double inside = 0.104 + 0.002 * i;
        CAPTURE(inside);
        const Vec3 post(1 - inside, inside, 1);
        const World world{"post", gantry(), {"", {make_ball("post", post, 1e-3)}}, {}};
        const CollisionChecker checker = make_checker(world);
        const MotionVerifier verifier(checker);
        TrajectorySettings settings;
        const auto left = parameterize(world.robot, kTurn, limits, settings, &verifier);
        settings.time_rounds = 0;
        const auto followed = parameterize(world.robot, kTurn, limits, settings, &verifier);
        const double most = std::isfinite(jerk) ? 0.99 : 1;
        CHECK(left.value().duration_s() <= most * followed.value().duration_s());
      }
    }
  }

  TEST_CASE("measures of a motion are its greatest rates and the integral of its jerk") {
    const EmptyScene empty(gantry());
    RateLimits limits = kOnes;
    limits.jerk = {4, 4, 4};
    const Trajectory motion = require_timed(empty, {{-1, 0, 1}, {1, 0, 1}}, limits);
    const MotionMeasures measures = measure_motion(motion, limits);
    CHECK(measures.duration_s == motion.duration_s());
    CHECK(measures.velocity[0] == doctest::Approx(1));
    CHECK(measures.acceleration[0] == doctest::Approx(1));
    CHECK(measures.jerk[0] == doctest::Approx(4));
    CHECK(measures.velocity[1] == 0);
    CHECK(measures.velocity_use[0] == doctest::Approx(1));
    CHECK(measures.jerk_use[0] == doctest::Approx(1));
    limits.velocity[0] = 4;
    CHECK(measure_motion(motion, limits).velocity_use[0] == doctest::Approx(0.25));
    CHECK(measure_motion(motion, kOnes).jerk_use[0] == 0);
    // Four ramps of a quarter of a second.
    CHECK(measures.jerk_integral == doctest::Approx(4 * 0.25 * 16));
    CHECK(measure_motion(require_timed(empty, {{1, 1, 1}}, limits), limits).jerk_integral == 0);
  }

  TEST_CASE("no rate between samples is greater than measured") {
    const EmptyScene empty(planar8());
    Rng rng(8);
    for (const int rounds : {0, 4}) {
      const RateLimits limits = random_jerk_limits(empty.robot(), rng);
      const Trajectory motion =
          require_timed(empty, random_path(empty.robot(), rng), limits, 0.1, rounds);
      const MotionMeasures measures = measure_motion(motion, limits);
      for (int i = 0; i <= 500; ++i) {
        const Trajectory::Point point = motion.at(motion.duration_s() * i / 500);
        CHECK(excess(point.velocity, measures.velocity) <= 0.02);
        CHECK(excess(point.acceleration, measures.acceleration) <= 0.02);
      }
    }
  }

  TEST_CASE("a path of one configuration is a trajectory of one point") {
    const EmptyScene empty(gantry());
    for (const Path& path : {Path{{1, 1, 1}}, Path{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}}) {
      const Trajectory motion = require_timed(empty, path, kOnes);
      CHECK(motion.duration_s() == 0);
      const auto points = motion.sample(0.01).value();
      REQUIRE(points.size() == 1);
      CHECK(points[0].position == Configuration{1, 1, 1});
    }
  }

  TEST_CASE("doubled waypoints change nothing") {
    const EmptyScene empty(gantry());
    const Path doubled = {kTurn[0], kTurn[0], kTurn[1], kTurn[1], kTurn[2], kTurn[2]};
    CHECK(require_timed(empty, doubled, kOnes).duration_s() ==
          require_timed(empty, kTurn, kOnes).duration_s());
  }

  TEST_CASE("what cannot be timed is refused with its reason") {
    CHECK(contains(refusal({}, kOnes), "without configurations"));
    CHECK(contains(refusal({{0, 0, 0}, {0, NAN, 0}}, kOnes), "waypoint 2: joint 'joint_2'"));
    CHECK(contains(refusal({{0, 0}}, kOnes), "waypoint 1: there are 2 values"));
    CHECK(contains(refusal({{0, 0, 5}}, kOnes), "outside its limits"));
    CHECK(contains(refusal(kTurn, {{1, 1}, {1, 1, 1}}), "2 limits of velocity"));
    CHECK(contains(refusal(kTurn, {{1, 1, 1}, {1, 1, 1, 1}}), "4 limits of acceleration"));
    for (const double bad : std::vector<double>{0, -1, NAN, INFINITY, 1e-9, 1e9}) {
      CHECK(contains(refusal(kTurn, {{1, bad, 1}, {1, 1, 1}}),
                     "joint 'joint_2': its limit of velocity"));
      CHECK(contains(refusal(kTurn, {{1, 1, 1}, {1, 1, bad}}),
                     "joint 'joint_3': its limit of acceleration"));
    }
    CHECK(contains(refusal(kTurn, {{1, 1, 1}, {1, 1, 1}, {1, 1}}), "2 limits of jerk"));
    for (const double bad : std::vector<double>{0, -1, NAN, 1e-9}) {
      CHECK(contains(refusal(kTurn, {{1, 1, 1}, {1, 1, 1}, {1, bad, INFINITY}}),
                     "joint 'joint_2': its limit of jerk"));
    }
    CHECK(contains(refusal(kTurn, kOnes, -1), "'path-tolerance' is -1"));
    CHECK(contains(refusal(kTurn, kOnes, NAN), "'path-tolerance' is nan"));
  }

  TEST_CASE("steps that are no time, or too many, are refused") {
    const EmptyScene empty(gantry());
    const Trajectory motion = require_timed(empty, kTurn, kOnes);
    for (const double bad : std::vector<double>{0, -0.01, NAN, INFINITY}) {
      CHECK(contains(require_error(motion.sample(bad)).message, "expected seconds above 0"));
    }
    CHECK(contains(motion.sample(1e-9).error().message, "choose a larger dt"));
  }
}

TEST_SUITE("law") {
  TEST_CASE("random paths are followed within the tolerance and limits, also of jerk") {
    for (const auto make_limits : std::array{&random_limits, &random_jerk_limits}) {
      for (const char* name : {"planar8", "panda", "fetch", "ur5"}) {
        const EmptyScene empty(load_robot(find_robot(name).value()).value());
        Rng rng(12);
        for (int i = 0; i < 100; ++i) {
          const Path path = random_path(empty.robot(), rng);
          const RateLimits limits = make_limits(empty.robot(), rng);
          const double tolerance = std::pow(10, rng.uniform(-4, 0));
          const Trajectory motion =
              require_timed(empty, path, limits, tolerance, i % 2 == 0 ? 0 : 8);
          const auto flaw = trajectory_flaw(empty.robot(), path, limits, tolerance, motion);
          CHECK_MESSAGE(!flaw, name, " ", i, ": ", flaw.value_or(""));
        }
      }
    }
  }

  TEST_CASE("velocity is the slope of position, and acceleration that of velocity") {
    const EmptyScene empty(planar8());
    Rng rng(4);
    for (int i = 0; i < 30; ++i) {
      CAPTURE(i);
      const Trajectory motion = require_timed(
          empty, random_path(empty.robot(), rng),
          {std::vector(8, 1.0), std::vector(8, 2.0), std::vector(8, i % 2 == 0 ? 7.0 : INFINITY)},
          0.1, i % 3 == 0 ? 4 : 0);
      const double h = 1e-5;
      for (int k = 0; k < 50; ++k) {
        const double t = rng.uniform(2 * h, motion.duration_s() - 2 * h);
        const auto a = motion.at(t - h), b = motion.at(t + h), c = motion.at(t);
        for (std::size_t j = 0; j < 8; ++j) {
          CHECK(std::abs((b.position[j] - a.position[j]) / (2 * h) - c.velocity[j]) < 1e-4);
          // Where acceleration jumps in between, the slope lies between both.
          const double slope = (b.velocity[j] - a.velocity[j]) / (2 * h);
          const auto [least, most] = std::minmax({a.acceleration[j], b.acceleration[j]});
          CHECK(slope >= least - 0.01);
          CHECK(slope <= most + 0.01);
        }
      }
    }
  }

  TEST_CASE("twice the velocities and four times the accelerations take half of the time") {
    const EmptyScene empty(planar8());
    Rng rng(9);
    for (int i = 0; i < 30; ++i) {
      const Path path = random_path(empty.robot(), rng);
      RateLimits limits = random_limits(empty.robot(), rng);
      const double once = require_timed(empty, path, limits).duration_s();
      for (double& velocity : limits.velocity) velocity *= 2;
      for (double& acceleration : limits.acceleration) acceleration *= 4;
      CHECK(require_timed(empty, path, limits).duration_s() == doctest::Approx(0.5 * once));
    }
  }

  TEST_CASE("a path that is followed backwards takes as long") {
    const EmptyScene empty(planar8());
    Rng rng(10);
    for (int i = 0; i < 30; ++i) {
      Path path = random_path(empty.robot(), rng);
      const RateLimits limits = random_limits(empty.robot(), rng);
      const double forth = require_timed(empty, path, limits).duration_s();
      std::ranges::reverse(path);
      CHECK(require_timed(empty, path, limits).duration_s() ==
            doctest::Approx(forth).epsilon(0.02));
    }
  }
}

TEST_SUITE("flow") {
  TEST_CASE("what a planner found is swept without contact, in seconds") {
    for (const World& world : small_worlds()) {
      CAPTURE(world.name);
      const CollisionChecker checker = make_checker(world);
      const auto planned = find_planner("rrt_connect").value();
      PathFinisher finish(checker, {});
      const auto sampler = make_uniform_sampler(world.robot);
      const auto result =
          planned->plan({checker, world.query, *sampler, PlanSettings{}, finish, ""});
      REQUIRE(result.has_value());
      REQUIRE(result->is_solved());
      for (const bool is_smooth : {false, true}) {
        TrajectorySettings settings;
        if (is_smooth) settings.jerk_limit = 4;
        const auto limits = require(find_rate_limits(world.robot, settings));
        const auto motion =
            parameterize(world.robot, result->path, limits, settings, &finish.verifier());
        REQUIRE(motion.has_value());
        const auto flaw =
            trajectory_flaw(world.robot, result->path, limits, settings.path_tolerance, *motion);
        CHECK_MESSAGE(!flaw, flaw.value_or(""));
        for (int i = 0; i <= 300; ++i) {
          const Configuration q = motion->at(motion->duration_s() * i / 300).position;
          CHECK(checker.contacts(q).empty());
        }
      }
    }
  }
}

}  // namespace mneme::test
