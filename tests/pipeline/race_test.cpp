// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/query.h"
#include "support/lifting_arm.h"
#include "support/no_threads.h"
#include "support/planar_circles.h"
#include "support/planar_memory.h"

#include <atomic>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace mneme::test {
namespace {

using internal::kAlone;

/// Seeds of the searches, as in race.cpp.
std::uint64_t seed_of_search(std::uint64_t seed, int index) {
  const auto task = (std::uint64_t{1} << 62) + static_cast<std::uint64_t>(index);
  return index == 0 ? seed : derive_seed(seed, task);
}

SolveSettings racing_settings(int threads) {
  SolveSettings settings;
  settings.threads = threads;
  settings.plan.timeout_s = 600;
  settings.plan.max_iterations = 200000;
  return settings;
}

/// Expected result of a race: runs each search by itself and picks the winner by the rules.
PlanResult expected_winner(const Problem& problem, Database* database, SolveSettings settings) {
  const int searches = std::exchange(settings.threads, 1);
  const std::uint64_t seed = settings.plan.seed;
  PlanResult best;
  std::uint64_t least = ~std::uint64_t{0};
  for (int i = 0; i < searches; ++i) {
    settings.plan.seed = seed_of_search(seed, i);
    if (i > 0) settings.plan.walk_after = 0;
    PlanResult plan = require(solve(problem, database, settings)).plan;
    REQUIRE(plan.is_solved());
    const std::uint64_t iterations = plan.iterations + (i == 0 ? 0 : kAlone);
    if (iterations >= least) continue;
    least = iterations;
    best = std::move(plan);
  }
  return best;
}

void check_same(const PlanResult& plan, const PlanResult& expected) {
  CHECK(plan.path == expected.path);
  CHECK(plan.iterations == expected.iterations);
  CHECK(plan.states_checked == expected.states_checked);
  CHECK(plan.nodes == expected.nodes);
}

/// Keeps all that it is shown.
struct Log : PlanObserver {
  void on_sample(std::span<const float> q, SampleSource) override {
    all.insert(all.end(), q.begin(), q.end());
  }
  void on_edge(std::span<const float> from, std::span<const float> to, int graph) override {
    all.insert(all.end(), from.begin(), from.end());
    all.insert(all.end(), to.begin(), to.end());
    all.push_back(static_cast<float>(graph));
  }
  std::vector<float> all;
};

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("of several searches the one with the fewest iterations wins, whatever the timing") {
    const Problem gap = planar_problem("threaded_b4");
    const Problem shelf{.name = "shelf",
                        .robot = lifting_arm(),
                        .scene = shelf_scene(),
                        .start = {0, 0, 0, 0},
                        .goals = {{0, 0, 0.6, -0.4}}};
    int others = 0;
    for (const std::string planner : {"rrt_connect", "rrt", "prm"}) {
      const Problem& problem = planner == "rrt_connect" ? gap : shelf;
      for (const int threads : {2, 3}) {
        SolveSettings settings = racing_settings(threads);
        settings.planner = planner;
        settings.sampler = "uniform";
        for (settings.plan.seed = 1; settings.plan.seed <= 4; ++settings.plan.seed) {
          INFO(planner, ", ", threads, " threads, seed ", settings.plan.seed);
          const PlanResult expected = expected_winner(problem, nullptr, settings);
          for (int i = 0; i < 3; ++i) {
            const SolveResult result = require(solve(problem, nullptr, settings));
            check_same(result.plan, expected);
            CHECK(result.seed == settings.plan.seed);
          }
          settings.threads = 1;
          if (require(solve(problem, nullptr, settings)).plan.path != expected.path) ++others;
          settings.threads = threads;
        }
      }
    }
    CHECK(others > 4);  // that it was not always the first
  }

  TEST_CASE("the same search wins where threads are refused") {
    const Problem problem = planar_problem("threaded_b4");
    SolveSettings settings = racing_settings(3);
    settings.sampler = "uniform";
    const PlanResult expected = expected_winner(problem, nullptr, settings);
    const NoThreads none;
    check_same(require(solve(problem, nullptr, settings)).plan, expected);
  }

  TEST_CASE("searches share a memory, and what it gave is told as of the one that won") {
    const Problem problem = planar_problem("threaded_b4");
    const TemporaryDirectory directory;
    Database database = make_database(directory / "m.db", problem.robot);
    const auto primitives = require(decompose(memory_query(problem)));
    learn_into(database, problem.robot, keys_near(primitives[0].key, 20, 0.2, 1));
    for (const int after : {0, 100, 400}) {
      SolveSettings settings = racing_settings(2);
      settings.retrieve_after = after;
      for (settings.plan.seed = 1; settings.plan.seed <= 6; ++settings.plan.seed) {
        INFO("seed ", settings.plan.seed, ", after ", after);
        const PlanResult expected = expected_winner(problem, &database, settings);
        const SolveResult result = require(solve(problem, &database, settings));
        check_same(result.plan, expected);
        const int components = result.gl.mixture ? result.gl.mixture->component_count() : 0;
        if (after == 0) CHECK(components > 0);
        if (expected.iterations <= static_cast<std::uint64_t>(after)) {
          CHECK(components == 0);
          CHECK(result.gl.primitives.empty());
        }
      }
    }
  }

  TEST_CASE("goals that are poses go on being resolved for each search by itself") {
    Problem problem = planar_problem("threaded_b4");
    const Transform tip = problem.robot.link_poses(problem.goals.front()).back();
    PoseGoal goal;
    goal.link = problem.robot.links().back().name;
    goal.pose = tip;
    goal.position_tolerance = Vec3::Constant(0.3);
    goal.cone = goal.turn = kPi;
    problem.goals.clear();
    problem.pose_goals = {goal};
    SolveSettings settings = racing_settings(2);
    settings.sampler = "uniform";
    for (settings.plan.seed = 1; settings.plan.seed <= 3; ++settings.plan.seed) {
      const SolveResult first = require_solved(problem, nullptr, settings);
      for (int i = 0; i < 4; ++i) {
        check_same(require(solve(problem, nullptr, settings)).plan, first.plan);
      }
    }
  }
}

TEST_SUITE("flow") {
  TEST_CASE("who watches a race sees the search that won") {
    const Problem problem = planar_problem("threaded_b4");
    SolveSettings settings = racing_settings(2);
    settings.sampler = "uniform";
    Log seen;
    settings.plan.observer = &seen;
    const PlanResult raced = require(solve(problem, nullptr, settings)).plan;
    settings.threads = 1;
    bool is_found = false;
    for (const int index : {0, 1}) {
      Log log;
      settings.plan.observer = &log;
      settings.plan.seed = seed_of_search(1, index);
      if (index > 0) settings.plan.walk_after = 0;
      if (require(solve(problem, nullptr, settings)).plan.path != raced.path) continue;
      is_found = true;
      CHECK(log.all == seen.all);
    }
    CHECK(is_found);
  }

  TEST_CASE("a race ends by its limits and when it is cancelled") {
    const Problem problem = planar_problem("threaded_b4");
    SolveSettings settings = racing_settings(3);
    settings.sampler = "uniform";
    const auto status = [&] { return require(solve(problem, nullptr, settings)).plan.status; };
    settings.plan.max_iterations = 100;
    CHECK(status() == PlanStatus::iteration_limit);
    settings.plan.max_iterations = 200000;
    settings.plan.max_nodes = 30;
    CHECK(status() == PlanStatus::node_limit);
    settings.plan.max_nodes = 10000000;
    settings.plan.timeout_s = 0;
    CHECK(status() == PlanStatus::timeout);
    settings.plan.timeout_s = 600;
    std::atomic<bool> cancel = true;
    settings.plan.cancel = &cancel;
    CHECK(status() == PlanStatus::cancelled);
  }

  TEST_CASE("all searches of a race end when another thread cancels it") {
    Problem problem = planar_problem("threaded_b4");
    problem.scene = ring_with_two_windows();
    problem.start = Configuration(8, 0.0);
    problem.goals = {Configuration(8, 0.0)};
    problem.goals[0][0] = kPi / 2;
    SolveSettings settings = racing_settings(3);
    settings.sampler = "uniform";
    settings.plan.max_iterations = std::nullopt;
    for (int round = 0; round < 4; ++round) {
      std::atomic<bool> cancel = false;
      settings.plan.cancel = &cancel;
      std::jthread canceller([&] {
        for (int i = 0; i < 5 * round; ++i) std::this_thread::yield();
        cancel = true;
      });
      CHECK(require(solve(problem, nullptr, settings)).plan.status == PlanStatus::cancelled);
    }
  }
}

}  // namespace mneme::test
