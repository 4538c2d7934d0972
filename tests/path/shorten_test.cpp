// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/planner_flow.h"

namespace mneme::test {
namespace {

Path shortened(const CollisionChecker& checker, Path path, std::uint64_t seed,
               Verification verification = Verification::states, double patience = 60) {
  CheckCounters counters;
  const MotionVerifier verifier(checker, verification);
  shorten(checker, path, seed, {patience, 0.003}, &verifier, counters);
  return path;
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("shortening never lengthens a path, keeps its ends and keeps it free") {
    for (const World& world : small_worlds()) {
      const CollisionChecker checker = make_checker(world);
      for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        for (const Verification verification :
             {Verification::none, Verification::states, Verification::motions}) {
          INFO(world.name, ", seed ", seed, ", verification ", static_cast<int>(verification));
          PlanSettings settings = patient_settings(seed);
          settings.simplify = false;
          const Path planned = run(prm, world, settings).path;
          const Path path = shortened(checker, planned, seed, verification);
          REQUIRE(path.size() >= 2);
          CHECK(path.front() == planned.front());
          CHECK(path.back() == planned.back());
          CHECK(path_length(world.robot, path) <=
                path_length(world.robot, planned) * (1 + 1e-6) + 1e-6);
          if (verification != Verification::none) {
            const auto flaw = path_flaw(checker, path);
            CHECK_MESSAGE(!flaw, flaw.value_or(""));
          }
          CHECK(path == shortened(checker, planned, seed, verification));
        }
      }
    }
  }
}

TEST_SUITE("law") {
  TEST_CASE("shortening that minimizes time never takes longer, and less than by length") {
    double by_time = 0, by_length = 0;
    for (const World& world : small_worlds()) {
      const CollisionChecker checker = make_checker(world);
      for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        INFO(world.name, ", seed ", seed);
        PlanSettings settings = patient_settings(seed);
        settings.simplify = false;
        const Path planned = run(prm, world, settings).path;
        const double before = path_time(world.robot, planned);
        for (const bool minimize_time : {false, true}) {
          Path path = planned;
          ShortenEffort effort;
          effort.minimize_time = minimize_time;
          CheckCounters counters;
          shorten(checker, path, seed, effort, nullptr, counters);
          const double after = path_time(world.robot, path);
          (minimize_time ? by_time : by_length) += after;
          if (minimize_time) CHECK(after <= before * (1 + 1e-5) + 1e-6);
        }
      }
    }
    CHECK(by_time < by_length);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("the time of a path is mostly that of the slowest joint of each motion") {
    const Robot robot = gantry();
    CHECK(path_time(robot, {}) == 0);
    CHECK(path_time(robot, {{0, 0, 1}}) == 0);
    const double speed = robot.group_joint(0).velocity;
    CHECK(path_time(robot, {{0, 0, 1}, {1, 0, 1}}) == doctest::Approx(1 / speed));
    const double both = path_time(robot, {{0, 0, 1}, {1, 1, 1}});
    CHECK(both > 1 / speed);
    CHECK(both < std::sqrt(2) / speed);
  }

  TEST_CASE("the time of a straight motion of one joint is that of up to seven segments") {
    const Robot robot = gantry();
    const auto time = [&](double length, const RateLimits& limits) {
      return path_time(robot, {{-1, 0, 1}, {-1 + length, 0, 1}}, &limits);
    };
    const RateLimits limits{{2, 2, 2}, {4, 4, 4}, {40, 40, 40}};
    // 0.1 s to the greatest acceleration and as long back, at least 0.4 s of it to 2 m/s.
    CHECK(time(2, limits) == doctest::Approx(2 / 2.0 + 0.6).epsilon(1e-5));
    CHECK(time(0.5, limits) == doctest::Approx(0.1 + std::sqrt(0.01 + 4 * 0.5 / 4)).epsilon(1e-5));
    CHECK(time(0.01, limits) == doctest::Approx(4 * std::cbrt(0.01 / 80)).epsilon(1e-5));
    const RateLimits no_jerk{{2, 2, 2}, {4, 4, 4}};
    CHECK(time(0.5, no_jerk) == doctest::Approx(2 * std::sqrt(0.5 / 4)).epsilon(1e-5));
    CHECK(time(2, no_jerk) == doctest::Approx(2 / 2.0 + 0.5).epsilon(1e-5));
  }

  TEST_CASE("where accelerations decide, velocity limits do not weigh joints") {
    const Robot robot = gantry();
    const RateLimits limits{{100, 50, 100}, {1, 1, 1}};
    const double along_x = path_time(robot, {{-1, 0, 1}, {0, 0, 1}, {1, 0, 1}}, &limits);
    CHECK(along_x == doctest::Approx(2 * std::sqrt(2)).epsilon(1e-5));
    const double l = path_time(robot, {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}}, &limits);
    const double mirrored = path_time(robot, {{0, 0, 1}, {0, 1, 1}, {1, 1, 1}}, &limits);
    CHECK(l == doctest::Approx(mirrored).epsilon(1e-5));
  }

  TEST_CASE("detours without an obstacle become one straight motion") {
    const World world{"", planar8(), {}, {}};
    const CollisionChecker checker = make_checker(world);
    const Configuration a(8, 0.1), b(8, -0.15), c(8, 0.2);
    CHECK(shortened(checker, {a, b, c}, 1) == Path{a, c});
    CHECK(shortened(checker, {a, b, c, b, c}, 1) == Path{a, c});
    CHECK(shortened(checker, {a, b, c, b, c}, 1, Verification::states, 0) == Path{a, c});
  }

  TEST_CASE("paths that have nothing to shorten stay as they are") {
    const World world{"", thick_arm({1, 1}), make_circle_scene("", {{1.5, 0, 0.2}}), {}};
    const CollisionChecker checker = make_checker(world);
    CHECK(shortened(checker, {}, 1).empty());
    const Path point = {{1, 0.1234567890123}};
    CHECK(shortened(checker, point, 1) == point);
    const Path motion = {{1, 0.1234567890123}, {2, 0.1}};
    CHECK(shortened(checker, motion, 1) == motion);
  }

  TEST_CASE("motions of no length do no harm") {
    const World world{"", thick_arm({1, 1}), {}, {}};
    const CollisionChecker checker = make_checker(world);
    const Configuration a = {0.5, 0.5}, b = {1.5, -0.5};
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      CHECK(shortened(checker, {a, a, a, a}, seed) == Path{a, a});
      CHECK(shortened(checker, {a, a, b, b, b}, seed) == Path{a, b});
    }
  }

  TEST_CASE("shortened paths lead through the jump of a continuous joint") {
    const World world{"", thick_arm({1, 1}), make_circle_scene("", {{1.5, 0, 0.2}}), {}};
    const CollisionChecker checker = make_checker(world);
    const Path path = shortened(checker, {{3, 0}, {2.5, 1}, {-2.6, 1}, {-3, 0}}, 1);
    CHECK(path == Path{{3, 0}, {-3, 0}});
  }

  TEST_CASE("every waypoint is free at the resolution of the planner, verified or not") {
    const Robot robot = thick_arm({1, 1});
    const CollisionChecker checker =
        make_checker(robot,
                     make_circle_scene(
                         "", {{1.9, 0.1, 0.05}, {1.5, 0.9, 0.05}, {0.9, -1.3, 0.05}, {-1, 1, 0.1}}),
                     {.resolution = 0.3});
    Rng rng(3);
    int in_contact = 0;
    for (std::uint64_t i = 0; i < 300; ++i) {
      const PlanQuery query{random_free_configuration(checker, rng),
                            {random_free_configuration(checker, rng)}};
      PlanSettings settings;
      settings.seed = i;
      settings.max_iterations = 100000;
      settings.verify = settings.simplify = false;
      Path path = plan_with(prm, checker, query, *make_uniform_sampler(robot), settings).path;
      CheckCounters counters;
      shorten(checker, path, i, {}, nullptr, counters);
      for (const Configuration& q : path) in_contact += checker.is_valid(q) ? 0 : 1;
    }
    CHECK(in_contact == 0);
  }
  TEST_CASE("shortened paths that are verified as motions touch nothing between states either") {
    const World world = posts_between_states();
    const CollisionChecker checker = make_checker(world, coarse_states());
    const Configuration& start = world.query.start;
    const Configuration& goal = world.query.goals.front();
    const Path round = {start, {-1.2, 0.3, 0.2, 0}, {-2.4, 0.3, 0.2, 0}, goal};
    CHECK(shortened(checker, round, 1, Verification::states) == Path{start, goal});
    const Path free = shortened(checker, round, 1, Verification::motions);
    CheckCounters counters;
    CHECK(find_invalid_motion(checker, free, counters, Verification::motions) == -1);
    CHECK(free.size() > 2);
  }
  TEST_CASE("more patience leads closer around an obstacle") {
    World world = small_worlds()[13];
    const CollisionChecker checker = make_checker(world);
    const Path detour = {{-1.5, 0.5, 0}, {-1.5, 1.9, 0}, {1.5, 1.9, 0}, {1.5, -0.5, 0.2}};
    const auto length = [&](double patience) {
      return path_length(world.robot,
                         shortened(checker, detour, 3, Verification::states, patience));
    };
    CHECK(length(0) <= path_length(world.robot, detour));
    CHECK(length(10) < length(0) - 0.1);
    CHECK(length(200) <= length(10));
    // Over the edges at (+-0.5, 1.1): the shortest way around.
    CHECK(length(200) < 1.03 * (std::hypot(1, 0.6) + 1 + std::hypot(1, 1.6)));
    CHECK(length(200) >= std::hypot(1, 0.6) + 1 + std::hypot(1, 1.6) - 0.2);
  }

  TEST_CASE("joints that nothing holds up go straight while others lead round an obstacle") {
    // Only the second value has to change on the way around the pillar; the third one wanders.
    World world{"", gantry(), {"", {make_box("pillar", {-0.3, -0.6, -3}, {0.3, 0.6, 3})}}, {}};
    const CollisionChecker checker = make_checker(world);
    const Path wandering = {{-1.5, 0, 0}, {-0.7, 0.9, 1.5}, {0.7, 0.9, -1.5}, {1.5, 0, 0}};
    const Path path = shortened(checker, wandering, 1);
    double sideways = 0;
    for (const Configuration& q : path) sideways = std::max(sideways, std::abs(q[2]));
    CHECK(sideways < 0.3);
    CHECK(path_length(world.robot, path) < 0.7 * path_length(world.robot, wandering));
  }

  TEST_CASE("shortened paths keep a millimetre, and less where an end has less") {
    World world{"table", gantry(), {"", {make_box("table", {-1, -1, -1}, {1, 1, 0})}}, {}};
    const CollisionChecker checker = make_checker(world);
    const Path over = {{-1.5, 0, 0.05}, {-1.2, 0, 0.8}, {1.2, 0, 0.8}, {1.5, 0, 0.05}};
    CheckCounters counters;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      Path path = over;
      shorten(checker, path, seed, {}, nullptr, counters);
      CHECK(path_length(world.robot, path) < path_length(world.robot, over) - 0.5);
      for (std::size_t i = 1; i < path.size(); ++i) {
        CHECK(checker.is_motion_valid(path[i - 1], path[i], {1, 0.9e-3}));
      }
    }
    Path close = {{-0.5, 0, 0.1003}, {0, 0, 0.8}, {0.5, 0, 0.1003}};
    shorten(checker, close, 1, {}, nullptr, counters);
    CHECK(close.size() == 2);
    CHECK(find_invalid_motion(checker, close, counters) == -1);
  }

  TEST_CASE("the length of a path counts the shorter way round") {
    const Robot arm = thick_arm({1, 1});
    CHECK(path_length(arm, {}) == 0);
    CHECK(path_length(arm, {{1, 1}}) == 0);
    CHECK(path_length(arm, {{3, 0}, {-3, 0}}) == doctest::Approx(2 * kPi - 6));
    CHECK(path_length(arm, {{0, 3}, {0, -3}}) == doctest::Approx(6));
    CHECK(path_length(arm, {{0, 0}, {3, 4}, {3, 4}}) == doctest::Approx(std::hypot(3, 4)));
  }
}

}  // namespace mneme::test
