// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Requirements on every planner. The test of each planner runs all of it; to add a planner, copy
/// the shortest of those tests.
#pragma once

#include "planning/scripted_sampler.h"
#include "planning/small_worlds.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>
#include <limits>
#include <thread>

namespace mneme::test {

/// Limits that no run of these tests comes near.
inline PlanSettings patient_settings(std::uint64_t seed = 1) {
  PlanSettings settings;
  settings.timeout_s = 120;
  settings.max_iterations = 3000000;
  settings.seed = seed;
  return settings;
}

/// One of mneme's own planners.
using OwnPlanner = PlanResult (*)(const PlanTask&);

inline PlanResult run(OwnPlanner plan, const World& world, const PlanSettings& settings) {
  return plan_with(plan, make_checker(world), world.query, *make_uniform_sampler(world.robot),
                   settings);
}

inline double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Processor time.
inline double work_seconds_since(std::clock_t begin) {
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

inline void check_solution(const World& world, const CollisionChecker& checker,
                           const PlanResult& result) {
  REQUIRE_MESSAGE(result.is_solved(), result.message);
  CHECK(result.message.empty());
  REQUIRE(result.path.size() >= 2);
  CHECK(result.path.front() == world.robot.normalized(world.query.start));
  CHECK(std::any_of(world.query.goals.begin(), world.query.goals.end(), [&](const auto& goal) {
    return result.path.back() == world.robot.normalized(goal);
  }));
  const auto flaw = path_flaw(checker, result.path);
  CHECK_MESSAGE(!flaw, flaw.value_or(""));
  CHECK(result.nodes >= 2);
  CHECK(result.states_checked > 0);
  CHECK(result.motions_checked > 0);
}

inline void check_solves_small_worlds(OwnPlanner plan) {
  for (const World& world : small_worlds()) {
    const CollisionChecker checker = make_checker(world);
    for (const bool simplify : {true, false}) {
      INFO(world.name, ", simplify ", simplify);
      PlanSettings settings = patient_settings();
      settings.simplify = simplify;
      check_solution(world, checker, run(plan, world, settings));
    }
  }
}

/// Random starts and goals, in a scene that leaves most of the arm's space connected.
inline void check_solves_random_queries(OwnPlanner plan) {
  World world{
      "random",
      spatial_arm(),
      {"",
       {make_box("post", {0.4, 0.4, -1}, {0.5, 0.5, 2}), make_ball("lamp", {-0.6, 0.2, 0.8}, 0.2),
        make_ball("ball", {0.3, -0.7, 0.3}, 0.25)}},
      {}};
  const CollisionChecker checker = make_checker(world);
  Rng rng(5);
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    INFO("seed ", seed);
    world.query = {random_free_configuration(checker, rng),
                   {random_free_configuration(checker, rng)}};
    check_solution(world, checker, run(plan, world, patient_settings(seed)));
  }
}

inline void check_reaches_any_goal(OwnPlanner plan) {
  World world = locked_arm();
  const Configuration locked = world.query.goals[0];
  Configuration open = world.query.start;
  for (std::size_t j = 1; j < open.size(); ++j) open[j] = -open[j];
  for (const auto& goals : {std::vector{locked, open}, {open, locked}, {open, open, locked}}) {
    world.query.goals = goals;
    const PlanResult result = run(plan, world, patient_settings());
    check_solution(world, make_checker(world), result);
    CHECK(result.path.back() == world.robot.normalized(open));
  }
}

inline void check_start_may_be_goal(OwnPlanner plan) {
  for (World world : small_worlds()) {
    INFO(world.name);
    world.query.start = world.query.goals[0];
    const PlanResult result = run(plan, world, patient_settings());
    check_solution(world, make_checker(world), result);
    CHECK(path_length(world.robot, result.path) == 0);
    CHECK(result.iterations == 0);
  }
}

inline void check_takes_the_shorter_way_round(OwnPlanner plan) {
  World world{"wrap", planar8(), {}, {Configuration(8, 0.25), {Configuration(8, 0.25)}}};
  world.query.start[0] = 3.0;
  world.query.goals[0][0] = -3.0;
  const PlanResult result = run(plan, world, patient_settings());
  check_solution(world, make_checker(world), result);
  CHECK(path_length(world.robot, result.path) == doctest::Approx(2 * kPi - 6));

  // The second joint has limits at +-pi and must not pass them.
  std::swap(world.query.start[0], world.query.start[1]);
  std::swap(world.query.goals[0][0], world.query.goals[0][1]);
  const PlanResult unwound = run(plan, world, patient_settings());
  check_solution(world, make_checker(world), unwound);
  CHECK(path_length(world.robot, unwound.path) >= 6);
}

inline void check_iteration_limit_is_exact(OwnPlanner plan) {
  const World world = boxed_goal();
  Rng rng(3);
  std::vector<Configuration> script;
  for (int i = 0; i < 1000; ++i) script.push_back(random_configuration(world.robot, rng));
  const ScriptedSampler sampler(script);
  for (const std::uint64_t limit : {1, 3, 17, 400}) {
    PlanSettings settings = patient_settings();
    settings.max_iterations = limit;
    settings.goal_bias = 0;
    const PlanResult result = plan_with(plan, make_checker(world), world.query, sampler, settings);
    CHECK(result.status == PlanStatus::iteration_limit);
    CHECK(result.iterations == limit);
    CHECK(sampler.log().drawn == limit);
    CHECK(result.path.empty());
    CHECK(contains(result.message, std::to_string(limit)));
  }
}

inline void check_node_limit_is_kept(OwnPlanner plan) {
  const World world = boxed_goal();
  PlanSettings settings = patient_settings();
  for (const std::uint64_t limit : {1, 2, 3, 100}) {
    settings.max_nodes = limit;
    const PlanResult result = run(plan, world, settings);
    CHECK(result.status == PlanStatus::node_limit);
    CHECK(result.nodes >= limit);
    CHECK(result.nodes <= std::max<std::uint64_t>(limit, 2));  // start and goal are always there
    CHECK(result.path.empty());
    CHECK(contains(result.message, std::to_string(limit)));
  }
  settings.max_nodes = 1000000000;
  settings.max_iterations = 1000;
  CHECK(run(plan, world, settings).status == PlanStatus::iteration_limit);
}

/// Steps so short that they round to no movement, or take seconds to reach a sample.
inline void check_tiny_range_keeps_the_time_limit(OwnPlanner plan) {
  for (const double range : {1e-6, 1e-8}) {
    PlanSettings settings;
    settings.timeout_s = 0.1;
    settings.range = range;
    const World world = boxed_goal();
    const CollisionChecker checker = make_checker(world);
    const std::clock_t begin_work = std::clock();
    CHECK(plan_with(plan, checker, world.query, *make_uniform_sampler(world.robot), settings)
              .status == PlanStatus::timeout);
    // A busy machine makes it wait, but not work for longer.
    CHECK(work_seconds_since(begin_work) < 0.4 * kSlowdown);
  }
}

inline void check_time_limit_is_kept(OwnPlanner plan) {
  for (const World& world : {locked_arm(), boxed_goal()}) {
    INFO(world.name);
    const CollisionChecker checker = make_checker(world);
    const auto sampler = make_uniform_sampler(world.robot);
    for (const double limit : {0.01, 0.2}) {
      PlanSettings settings;
      settings.timeout_s = limit;
      const auto begin = std::chrono::steady_clock::now();
      const std::clock_t begin_work = std::clock();
      const PlanResult result = plan_with(plan, checker, world.query, *sampler, settings);
      const double elapsed = seconds_since(begin);
      CHECK(result.status == PlanStatus::timeout);
      CHECK(elapsed >= limit);
      CHECK(work_seconds_since(begin_work) < limit + 0.05 * kSlowdown);
      CHECK(result.planning_time_s <= elapsed);
      CHECK(result.planning_time_s >= 0);
    }
  }
}

inline void check_zero_time_limit(OwnPlanner plan) {
  for (const World& world : small_worlds()) {
    INFO(world.name);
    PlanSettings settings;
    settings.timeout_s = 0;
    const PlanResult result = run(plan, world, settings);
    CHECK(result.status == PlanStatus::timeout);
    CHECK(result.iterations == 0);
    CHECK(result.path.empty());
    CHECK(!result.message.empty());
  }
}

/// Another thread cancels once the planner is at work. What the planner still does then is counted,
/// because a busy machine may let it wait for as long as it likes.
inline void check_can_be_cancelled(OwnPlanner plan) {
  const World world = locked_arm();
  const CollisionChecker checker = make_checker(world);
  Rng rng(9);
  std::vector<Configuration> script;
  for (int i = 0; i < 5000; ++i) script.push_back(random_configuration(world.robot, rng));
  constexpr int kMostAfterwards = 64;
  std::atomic<bool> is_running = false, is_cancelled = false;
  int drawn_afterwards = 0;
  const ScriptedSampler sampler(script, [&](std::uint64_t drawn) {
    drawn_afterwards += is_cancelled;
    if (drawn != 200) return;
    is_running = true;
    is_running.notify_one();
  });
  std::jthread canceller([&] {
    is_running.wait(false);
    is_cancelled = true;
  });
  PlanSettings settings = patient_settings();
  settings.max_iterations.reset();
  settings.cancel = &is_cancelled;
  const PlanResult result = plan_with(plan, checker, world.query, sampler, settings);
  canceller.join();
  CHECK(result.status == PlanStatus::cancelled);
  CHECK(result.path.empty());
  CHECK(result.iterations >= 200);
  CHECK(drawn_afterwards <= kMostAfterwards);
}

inline void check_refused(const PlanResult& result, PlanStatus status,
                          const std::vector<std::string>& words) {
  CHECK(result.status == status);
  CHECK(result.path.empty());
  CHECK(result.iterations == 0);
  for (const std::string& word : words) {
    CHECK_MESSAGE(contains(result.message, word), result.message, " lacks ", word);
  }
}

/// Puts `q` in the place of the start, of the only goal, and of the second goal.
inline void check_refuses(OwnPlanner plan, const World& good, const Configuration& q,
                          const std::vector<std::string>& words) {
  World world = good;
  world.query.start = q;
  check_refused(run(plan, world, {}), PlanStatus::invalid_start, words);
  world = good;
  world.query.goals = {q};
  check_refused(run(plan, world, {}), PlanStatus::invalid_goal, words);
  world.query.goals = {good.query.goals[0], q};
  check_refused(run(plan, world, {}), PlanStatus::invalid_goal, words);
}

inline void check_refuses_bad_queries(OwnPlanner plan) {
  World world{"bad",
              planar8(),
              make_circle_scene("", {{4, 4, 1.5}, {-5, -5, 1}}),
              {Configuration(8, 0.1), {Configuration(8, -0.1)}}};
  world.scene.obstacles[0].name = "pillar";
  const double infinity = std::numeric_limits<double>::infinity();
  const auto with = [&](std::size_t joint, double value) {
    Configuration q = world.query.start;
    q[joint] = value;
    return q;
  };
  check_refuses(plan, world, with(2, std::nan("")), {"joint_3", "finite"});
  check_refuses(plan, world, with(0, infinity), {"joint_1", "finite"});
  check_refuses(plan, world, Configuration(7, 0.0), {"7 values", "8 joints"});
  check_refuses(plan, world, Configuration(9, 0.0), {"9 values", "8 joints"});
  check_refuses(plan, world, {}, {"0 values"});
  check_refuses(plan, world, with(4, kPi + 1e-3), {"joint_5", "limits"});
  check_refuses(plan, world, with(4, -kPi - 1e-3), {"joint_5", "limits"});
  // Straight along the diagonal, into the circle at (4, 4).
  Configuration touching(8, 0.0);
  touching[0] = kPi / 4;
  check_refuses(plan, world, touching, {"in contact", "link_3", "'pillar'"});
  // A closed triangle and more: links that cross.
  check_refuses(plan, world, {0, 2.5, 2.5, 0, 0, 0, 0, 0}, {"in contact", "touches link"});
  world.query.goals.clear();
  check_refused(run(plan, world, {}), PlanStatus::invalid_goal, {"no goal"});
}

/// Rounding in files puts values a little outside the limits; they are clamped.
inline void check_clamps_rounding_errors(OwnPlanner plan) {
  const World slider{"clamp", gantry(), {}, {{-2 - 1e-6, 0, 2 + 1e-6}, {{2 + 1e-6, 0, 0}}}};
  const PlanResult result = run(plan, slider, patient_settings());
  REQUIRE_MESSAGE(result.is_solved(), result.message);
  CHECK(result.path.front() == Configuration{-2, 0, 2});
  CHECK(result.path.back() == Configuration{2, 0, 0});

  // A continuous joint is wrapped, however often it went round.
  World arm{"wrap", thick_arm({1, 1}), {}, {{7 * kPi, 0.5}, {{-20, 0.5}}}};
  const PlanResult wrapped = run(plan, arm, patient_settings());
  check_solution(arm, make_checker(arm), wrapped);
}

inline void check_is_repeatable(OwnPlanner plan) {
  const World world = small_worlds()[8];
  PlanSettings settings = patient_settings(7);
  settings.simplify = false;
  const PlanResult first = run(plan, world, settings), second = run(plan, world, settings);
  REQUIRE(first.is_solved());
  CHECK(first.path == second.path);
  CHECK(first.iterations == second.iterations);
  CHECK(first.states_checked == second.states_checked);
  CHECK(first.nodes == second.nodes);
  int differing = 0;
  for (std::uint64_t seed = 8; seed < 12; ++seed) {
    settings.seed = seed;
    differing += run(plan, world, settings).path != first.path;
  }
  CHECK(differing >= 3);

  settings = patient_settings(7);
  CHECK(run(plan, world, settings).path == run(plan, world, settings).path);
}

/// Thin posts between states that are far apart: what comes back survives ten times the resolution.
inline void check_verification_catches_tunnelling(OwnPlanner plan) {
  World world{"posts", thick_arm({1, 1}), {}, {{-1, 0.4}, {{1, 0.4}}}};
  world.scene = make_circle_scene("", {{1.9, 0.1, 0.01}, {1.5, 0.3, 0.01}, {0.9, -0.3, 0.01}});
  const CollisionChecker checker = make_checker(world, {.resolution = 0.5});
  const auto sampler = make_uniform_sampler(world.robot);
  int tunnelled = 0, solved = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    INFO("seed ", seed);
    for (const bool simplify : {false, true}) {
      PlanSettings settings = patient_settings(seed);
      settings.max_iterations = 20000;
      settings.simplify = simplify;
      const PlanResult result = plan_with(plan, checker, world.query, *sampler, settings);
      CheckCounters counters;
      if (result.is_solved()) CHECK(find_invalid_motion(checker, result.path, counters) == -1);
      solved += result.is_solved();
      settings.verify = false;
      const PlanResult unverified = plan_with(plan, checker, world.query, *sampler, settings);
      REQUIRE(unverified.is_solved());
      CHECK(unverified.verification_time_s == 0);
      tunnelled += find_invalid_motion(checker, unverified.path, counters) >= 0;
    }
  }
  CHECK(solved >= 10);
  CHECK(tunnelled >= 5);
}

/// Configurations at most `step` apart along a path.
inline std::vector<Configuration> dense(const Robot& robot, const Path& path, double step) {
  std::vector<Configuration> result = {path.front()};
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Configuration delta = robot.difference(path[i - 1], path[i]);
    const int count = static_cast<int>(std::ceil(robot.distance(path[i - 1], path[i]) / step));
    for (int k = 1; k <= count; ++k) {
      Configuration q = path[i - 1];
      for (std::size_t j = 0; j < q.size(); ++j) q[j] += delta[j] * k / count;
      result.push_back(robot.normalized(q));
    }
  }
  return result;
}

inline void check_continuous_verification(OwnPlanner plan) {
  const CollisionChecker checker = make_checker(posts_between_states(), coarse_states());
  const auto sampler = make_uniform_sampler(checker.robot());
  for (const bool is_continuous : {false, true}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      INFO("seed ", seed, ", continuous ", is_continuous);
      PlanSettings settings = patient_settings(seed);
      settings.continuous = is_continuous;
      const PlanResult result =
          plan_with(plan, checker, posts_between_states().query, *sampler, settings);
      REQUIRE(result.is_solved());
      bool is_free = true;
      for (const Configuration& q : dense(checker.robot(), result.path, 1e-3)) {
        is_free = is_free && checker.is_valid(q);
      }
      CHECK(is_free == is_continuous);
    }
  }
}

/// From one side to just the other: two ways of the same length lead there, of which one is
/// blocked.
inline void check_half_turns(OwnPlanner plan) {
  for (const double side : {-1.0, 1.0}) {
    const World world{"half a turn",
                      thick_arm({1, 1}),
                      make_circle_scene("", {{0, 1.5 * side, 0.2}}),
                      {{0, 0.2}, {{kPi, 0.2}}}};
    const CollisionChecker checker = make_checker(world);
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const PlanResult result = run(plan, world, patient_settings(seed));
      check_solution(world, checker, result);
      CHECK(result.path.size() > 2);
    }
  }
}

/// Algorithm 1 replaces the random configuration: a planner that is told the way through a narrow
/// passage takes it within `limit` draws, while uniform configurations do not lead through it.
inline void check_samples_lead_the_way(OwnPlanner plan, std::uint64_t limit) {
  World world{"narrow",
              planar8(),
              make_circle_scene("", {{0.2, -3.25, 1.3}, {-2.4, -3.45, 1.0}}),
              {{-1.301, -1.858, 1.489, 0.114, 0.249, -3.136, 1.945, -0.726},
               {{2.673, -2.044, 1.62, -0.274, 1.549, -1.328, -0.609, -1.756}}}};
  const PlanResult known = run(rrt_connect, world, patient_settings(3));
  REQUIRE(known.is_solved());
  const ScriptedSampler sampler(dense(world.robot, known.path, 0.2));
  const CollisionChecker checker = make_checker(world);
  PlanSettings settings = patient_settings();
  settings.max_iterations = limit;
  const PlanResult told = plan_with(plan, checker, world.query, sampler, settings);
  check_solution(world, checker, told);
  CHECK(sampler.log().drawn > 0);
  settings.anchor = 0;
  settings.walk = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    settings.seed = seed;
    CHECK(run(plan, world, settings).status == PlanStatus::iteration_limit);
  }
}

/// Each report goes to the source of the latest sample that is not reported yet.
inline void check_reports_every_draw(OwnPlanner plan) {
  const World world = boxed_goal();
  Rng rng(12);
  std::vector<Configuration> script;
  for (int i = 0; i < 160; ++i) script.push_back(random_configuration(world.robot, rng));
  script[5] = {0.25, 0.1, 0.1};  // in a wall of the box
  const ScriptedSampler sampler(script);
  PlanSettings settings = patient_settings();
  settings.max_iterations = script.size();
  settings.goal_bias = 0;
  const PlanResult result = plan_with(plan, make_checker(world), world.query, sampler, settings);
  CHECK(result.status == PlanStatus::iteration_limit);
  REQUIRE(sampler.log().reports.size() == script.size());
  for (std::size_t i = 0; i < script.size(); ++i) {
    CHECK(sampler.log().reports[i].first == static_cast<SampleSource>(i));
  }
  const auto accepted =
      std::count_if(sampler.log().reports.begin(), sampler.log().reports.end(),
                    [](const auto& report) { return report.second != SampleOutcome::rejected; });
  CHECK(accepted > 0);
  CHECK(static_cast<std::uint64_t>(accepted) <= result.nodes);
}

/// Records what an observer receives, to check it.
struct Watcher : PlanObserver {
  std::vector<std::vector<float>> samples;
  std::vector<std::pair<Configuration, Configuration>> edges;
  int last_graph = 0;
  void on_sample(std::span<const float> q, SampleSource source) override {
    CHECK(source == kUniformSource);
    samples.emplace_back(q.begin(), q.end());
  }
  void on_edge(std::span<const float> from, std::span<const float> to, int graph) override {
    edges.emplace_back(Configuration(from.begin(), from.end()),
                       Configuration(to.begin(), to.end()));
    last_graph = std::max(last_graph, graph);
  }
};

inline void check_can_be_watched(OwnPlanner plan, int last_graph) {
  const World world = boxed_goal();
  const CollisionChecker checker = make_checker(world);
  Watcher watcher;
  PlanSettings settings = patient_settings();
  settings.max_iterations = 400;
  const PlanResult alone = run(plan, world, settings);
  settings.observer = &watcher;
  const PlanResult watched = run(plan, world, settings);
  CHECK(watched.status == alone.status);
  CHECK(watched.motions_checked == alone.motions_checked);
  CHECK(watcher.samples.size() > 300);
  CHECK(watcher.samples.size() <= watched.iterations);
  // Start, goals and isolated milestones are nodes without an edge.
  CHECK(watcher.edges.size() > 2);
  CHECK(watcher.edges.size() <= watched.nodes);
  for (const auto& [from, to] : watcher.edges) CHECK(checker.is_motion_valid(from, to));
  // Nothing grows from a goal in a box.
  for (const World& open : small_worlds()) {
    CHECK(run(plan, open, settings).iterations <= settings.max_iterations);
  }
  CHECK(watcher.last_graph == last_graph);
}

}  // namespace mneme::test
