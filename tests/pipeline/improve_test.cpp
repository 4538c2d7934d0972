// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/improve.h"
#include "support/planar_memory.h"

#include <memory>

namespace mneme::test {
namespace {

SolveResult improved(const Problem& problem, std::uint64_t rounds) {
  SolveSettings settings;
  settings.plan.timeout_s = 60;
  if (rounds > 0) {
    settings.plan.improve = 1000;
    settings.plan.improve_rounds = rounds;
  }
  SolveResult result = require_solved(problem, nullptr, settings);
  return result;
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("more rounds never lead to a longer path, and what improves is verified") {
    const Problem problem = planar_problem("threaded_b2");
    const auto checker = require(CollisionChecker::make(problem.robot, problem.scene));
    double last = path_length(problem.robot, improved(problem, 0).plan.path);
    const double first = last;
    for (const std::uint64_t rounds : {1, 2, 4, 8}) {
      const SolveResult result = improved(problem, rounds);
      const double length = path_length(problem.robot, result.plan.path);
      CHECK(length <= last);
      last = length;
      CheckCounters counters;
      CHECK(find_invalid_motion(checker, result.plan.path, counters) == -1);
      CHECK(result.plan.path.front() == problem.start);
      CHECK(result.planning_time_s + result.improvement_time_s <= result.total_time_s);
    }
    CHECK(last < first);
  }

  TEST_CASE("the curve of improvements falls and ends at the path that comes back") {
    const Problem problem = planar_problem("threaded_b0");
    const SolveResult result = improved(problem, 6);
    REQUIRE(result.improvements.size() > 1);
    CHECK(result.improvements.front().time_s == 0);
    CHECK(result.improvements.front().path_length ==
          path_length(problem.robot, improved(problem, 0).plan.path));
    for (std::size_t i = 1; i < result.improvements.size(); ++i) {
      CHECK(result.improvements[i].path_length < result.improvements[i - 1].path_length);
      CHECK(result.improvements[i].time_s >= result.improvements[i - 1].time_s);
    }
    CHECK(result.improvements.back().path_length == path_length(problem.robot, result.plan.path));
  }

  TEST_CASE("the curve of improvements in time ends at the path that comes back") {
    const Problem problem = planar_problem("threaded_b0");
    SolveSettings settings;
    settings.plan.timeout_s = 60;
    settings.plan.minimize_time = true;
    settings.plan.improve = 1000;
    settings.plan.improve_rounds = 6;
    const SolveResult result = require_solved(problem, nullptr, settings);
    REQUIRE(!result.improvements.empty());
    CHECK(result.improvements.back().path_length == path_length(problem.robot, result.plan.path));
    settings.plan.improve = 0;
    settings.plan.improve_rounds.reset();
    const Path first = require_solved(problem, nullptr, settings).plan.path;
    CHECK(result.improvements.front().path_length == path_length(problem.robot, first));
    CHECK(path_time(problem.robot, result.plan.path) <= path_time(problem.robot, first));
  }

  TEST_CASE("the same number of rounds leads to the same path") {
    const Problem problem = planar_problem("threaded_b4");
    CHECK(improved(problem, 3).plan.path == improved(problem, 3).plan.path);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("paths of trajectories are improved a little without a time to do so") {
    int faster = 0;
    for (const char* name : {"threaded_b0", "threaded_b2", "threaded_b4"}) {
      CAPTURE(name);
      const Problem problem = planar_problem(name);
      SolveSettings settings;
      settings.plan.timeout_s = 60;
      const auto limits =
          std::make_shared<const RateLimits>(find_rate_limits(problem.robot).value());
      settings.plan.limits = limits;
      const SolveResult result = solve(problem, nullptr, settings).value();
      REQUIRE(result.plan.is_solved());
      CHECK(result.improvements.empty());
      CHECK(solve(problem, nullptr, settings).value().plan.path == result.plan.path);
      const auto checker = CollisionChecker::make(problem.robot, problem.scene).value();
      CheckCounters counters;
      CHECK(find_invalid_motion(checker, result.plan.path, counters) == -1);
      settings.plan.improve = 1e-9;
      CHECK(solve(problem, nullptr, settings).value().plan.path == result.plan.path);
      settings.plan.improve = 0;
      settings.plan.simplify = false;
      const SolveResult rough = solve(problem, nullptr, settings).value();
      REQUIRE(rough.plan.is_solved());
      const MotionVerifier verifier(checker);
      const auto duration_s = [&](const Path& path) {
        return estimate_duration(problem.robot, path, *limits, &verifier);
      };
      faster += duration_s(result.plan.path) < duration_s(rough.plan.path) ? 1 : 0;
    }
    CHECK(faster == 3);
  }

  TEST_CASE("a path of a trajectory is shortened in length, too, before other plans") {
    const Problem problem = planar_problem("threaded_b2");
    SolveSettings settings;
    settings.plan.timeout_s = 60;
    settings.plan.simplify = false;
    const Path rough = solve(problem, nullptr, settings).value().plan.path;
    const auto limits = std::make_shared<const RateLimits>(find_rate_limits(problem.robot).value());
    settings.plan.simplify = true;
    settings.plan.limits = limits;
    settings.plan.improve = 1000;
    settings.plan.improve_rounds = 1;
    const auto query = require(internal::make_query(problem, nullptr, settings));
    const auto resolved = require(internal::resolve_goals(query));
    const MotionVerifier verifier(resolved.checker);
    ShortenEffort in_time;
    in_time.minimize_time = true;
    in_time.limits = limits.get();
    CheckCounters counters;
    double improved_s = 0, again_s = 0;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      SolveResult result;
      result.plan.status = PlanStatus::solved;
      result.plan.path = rough;
      shorten(resolved.checker, result.plan.path, seed, in_time, nullptr, counters, {});
      Path again = result.plan.path;
      shorten(resolved.checker, again, seed + 8, in_time, nullptr, counters, {});
      again_s += estimate_duration(problem.robot, again, *limits, &verifier);
      internal::improve(resolved, *make_uniform_sampler(problem.robot), result);
      improved_s += estimate_duration(problem.robot, result.plan.path, *limits, &verifier);
    }
    CAPTURE(again_s);
    CHECK(improved_s < 0.985 * again_s);
  }

  TEST_CASE("faster motions that are not found are not searched for until time is up") {
    // A slow joint leaves a thin box for faster motions, and a post blocks nearly all of it.
    const Robot arm = parse_robot(R"(<robot name="arm">
      <link name="base"/>
      <link name="upper"><collision><origin xyz="0 0 0.25"/>
        <geometry><capsule radius="0.03" length="0.3"/></geometry></collision></link>
      <link name="fore"><collision><origin xyz="0 0 0.25"/>
        <geometry><capsule radius="0.05" length="0.4"/></geometry></collision></link>
      <link name="tip"><collision><geometry><sphere radius="0.02"/></geometry></collision></link>
      <joint name="pan" type="continuous"><parent link="base"/><child link="upper"/>
        <origin xyz="0 0 0.1"/><axis xyz="0 0 1"/><limit velocity="2" effort="1"/></joint>
      <joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/>
        <origin xyz="0 0 0.5"/><axis xyz="0 1 0"/>
        <limit lower="-2.5" upper="2.5" velocity="0.17" effort="1"/></joint>
      <joint name="slide" type="prismatic"><parent link="fore"/><child link="tip"/>
        <origin xyz="0 0 0.5"/><axis xyz="1 0 0"/>
        <limit lower="0" upper="0.04" velocity="0.1" effort="1"/></joint>
      </robot>)",
                                  "arm.urdf")
                          .value();
    Problem problem{
        .name = "post", .robot = arm, .start = {-0.8, 1.2, 0.02}, .goals = {{1.2, 1.4, 0.03}}};
    const Transform pose{Eigen::Matrix3d::Identity(), {0.4, 0.1, 0.6}};
    problem.scene.obstacles.push_back({"post", {Cylinder{pose, 0.04, 1.2}}});
    SolveSettings settings;
    settings.plan.timeout_s = 600;
    settings.plan.limits = std::make_shared<const RateLimits>(find_rate_limits(arm).value());
    for (settings.plan.seed = 1; settings.plan.seed < 10; ++settings.plan.seed) {
      const SolveResult result = solve(problem, nullptr, settings).value();
      REQUIRE(result.plan.is_solved());
      CHECK(result.plan.iterations < 10000);
    }
  }

  TEST_CASE("without time to improve nothing is improved") {
    const SolveResult result = improved(planar_problem("threaded_b0"), 0);
    CHECK(result.improvements.empty());
    CHECK(result.improvement_time_s == 0);
  }

  TEST_CASE("improving ends at once if the path is straight") {
    Problem problem = planar_problem("threaded_b0");
    problem.scene.obstacles.clear();
    const SolveResult result = improved(problem, 3);
    CHECK(result.plan.path.size() == 2);
    CHECK(result.improvements.size() == 1);
    CHECK(result.plan.states_checked == improved(problem, 0).plan.states_checked);
  }

  TEST_CASE("a path to a goal that came while planning is improved, too") {
    const Robot arm = limited_arm({1, 1}, -0.5, 2.5);
    const Problem problem{.name = "far", .robot = arm, .start = {0, 0}, .goals = {{2.4, 2.4}}};
    SolveSettings settings;
    settings.plan.improve = 1000;
    settings.plan.improve_rounds = 1;
    const auto query = require(internal::make_query(problem, nullptr, settings));
    SolveResult result;
    result.plan.status = PlanStatus::solved;
    result.plan.path = {{0, 0}, {0.5, 0}, {0.5, 0.5}};
    const auto resolved = require(internal::resolve_goals(query));
    internal::improve(resolved, *make_uniform_sampler(arm), result);
    CHECK(path_length(arm, result.plan.path) < 0.71);
  }

  TEST_CASE("improving ends when its time is up") {
    SolveSettings settings;
    settings.plan.improve = 1e-9;
    const SolveResult result = require_solved(planar_problem("threaded_b0"), nullptr, settings);
    CHECK(result.improvements.size() <= 2);
    settings.plan.improve = -1;
    CHECK(solve(planar_problem("threaded_b0"), nullptr, settings).error().code ==
          ErrorCode::invalid);
  }

  TEST_CASE("rounds of improving without time for any are refused") {
    SolveSettings settings;
    settings.plan.improve_rounds = 3;
    const Error error = require_error(solve(planar_problem("threaded_b0"), nullptr, settings));
    CHECK(error.message ==
          "setting 'improve-rounds' has no effect without 'improve': set a time to improve");
  }
}

}  // namespace mneme::test
