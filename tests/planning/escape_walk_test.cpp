// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/planner_flow.h"
#include "planning/planning_fixture.h"
#include "planning/escape_walk.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>

namespace mneme::test {
namespace {

constexpr int kMostSteps = 30;

PlanSettings walking(std::optional<double> share, std::optional<std::uint64_t> after = 0) {
  PlanSettings settings;
  settings.walk = share;
  settings.walk_after = after;
  settings.timeout_s = 120;
  return settings;
}

World threaded_world() {
  const Problem problem = planar_problem("threaded_b4");
  return {"threaded", problem.robot, problem.scene, {problem.start, problem.goals}};
}

World reaching_world() {
  return {"reaching",
          spatial_arm(),
          {"",
           {make_ball("left", {0.8, 0.4, 0.3}, 0.25), make_ball("right", {0.8, -0.4, 0.3}, 0.25),
            make_box("board", {0.2, -0.6, 0.8}, {1.2, 0.6, 0.85})}},
          {{0, 0.1, 0, 0}, {{2, -0.5, 1, 0}}}};
}

/// Sees edges in the order in which they are added.
struct EdgeLog : PlanObserver {
  struct Edge {
    std::vector<float> from, to;
    int graph = 0;
  };
  std::vector<Edge> edges;
  void on_edge(std::span<const float> from, std::span<const float> to, int graph) override {
    edges.push_back({{from.begin(), from.end()}, {to.begin(), to.end()}, graph});
  }
};

std::vector<float> values_of(std::span<const float> q) { return {q.begin(), q.end()}; }

/// Iterations of a run that are walks, of `count`.
int count_due(const World& world, const PlanSettings& settings, int count) {
  RunFixture f(world, settings);
  internal::EscapeWalk walk(f.run);
  int due = 0;
  for (int i = 0; i < count; ++i) {
    due += walk.is_due() ? 1 : 0;
    REQUIRE(f.run.begin_iterations() == 1);
  }
  return due;
}

/// Share of walks in the work of a run that otherwise checks states.
double share_of_walks(const World& world, const PlanSettings& settings) {
  RunFixture f(world, settings);
  internal::EscapeWalk walk(f.run);
  internal::Tree tree(f.run);
  tree.add(f.run.start(), -1);
  std::vector<float> states;
  for (int i = 0; i < 16; ++i) states.insert(states.end(), tree[0].begin(), tree[0].end());
  std::vector<std::uint8_t> is_valid(16);
  std::uint64_t walked = 0, longest = 0;
  for (int i = 0; i < 10000; ++i) {
    REQUIRE(f.run.begin_iterations() == 1);
    if (!walk.is_due()) {
      f.run.check_states(states, is_valid);
      continue;
    }
    const std::uint64_t before = f.run.work();
    walk.extend(tree);
    longest = std::max(longest, f.run.work() - before);
    walked += f.run.work() - before;
    const double most = settings.walk.value_or(1) * static_cast<double>(f.run.work());
    CHECK(static_cast<double>(walked) <= most + static_cast<double>(longest));
  }
  return static_cast<double>(walked) / static_cast<double>(f.run.work());
}

/// A tree of what `count` walks from the start add.
internal::FloatPath nodes_of_walks(const World& world, const PlanSettings& settings, Isa isa,
                                   int count) {
  RunFixture f(world, settings, isa);
  internal::EscapeWalk walk(f.run);
  internal::Tree tree(f.run);
  tree.add(f.run.start(), -1);
  for (int i = 0; i < count; ++i) walk.extend(tree);
  internal::FloatPath nodes;
  for (int i = 0; i < tree.size(); ++i) nodes.push_back(values_of(tree[i]));
  return nodes;
}

/// Checks one walk's edges from number `begin`: a chain from the newest node, valid and within the
/// limits.
void check_chain(const CollisionChecker& checker, const EdgeLog& log, std::size_t begin,
                 std::vector<float> newest) {
  CHECK(log.edges.size() - begin <= kMostSteps);
  for (std::size_t i = begin; i < log.edges.size(); ++i) {
    const auto& [from, to, graph] = log.edges[i];
    REQUIRE(from == newest);
    const Configuration end(to.begin(), to.end());
    REQUIRE(!checker.robot().describe_violation(end, "node"));
    // Exact distances differ from the kernels' by rounding.
    for (const Contact& contact : checker.contacts(end)) CHECK(contact.distance > -1e-4);
    CheckCounters counters;
    CHECK(checker.is_motion_valid(std::span<const float>(from), to, counters));
    newest = to;
  }
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("no walk is due before its time, nor at all if there should be none") {
    const World world = threaded_world();
    RunFixture f(world, walking(1, 50));
    internal::EscapeWalk walk(f.run);
    for (int i = 0; i < 100; ++i) {
      CHECK(walk.is_due() == (i >= 50));
      REQUIRE(f.run.begin_iterations() == 1);
    }
    CHECK(count_due(world, walking(0), 2000) == 0);
    CHECK(count_due(world, walking(1), 2000) == 2000);
  }

  TEST_CASE("walks take the share of the work that the settings say, or that suits the robot") {
    CHECK(std::abs(share_of_walks(threaded_world(), walking(0.5)) - 0.5) < 0.015);
    CHECK(std::abs(share_of_walks(threaded_world(), walking({}, {})) - 0.7) < 0.015);
    CHECK(std::abs(share_of_walks(reaching_world(), walking({})) - 0.2) < 0.015);
    CHECK(std::abs(share_of_walks(reaching_world(), walking(0.05)) - 0.05) < 0.015);
    CHECK(count_due(reaching_world(), walking(1, {}), 3000) == 0);
    CHECK(count_due(reaching_world(), walking(1, {}), 3010) == 10);
  }

  TEST_CASE("robots without limbs never walk") {
    const World slider{"", gantry(), {}, {{0, 0, 0}, {{1, 0, 0}}}};
    const World chain{
        "", chain_without_limbs(), {}, {Configuration(33, 0.1), {Configuration(33, -0.1)}}};
    CHECK(count_due(slider, walking(1), 100) == 0);
    CHECK(count_due(chain, walking(1), 100) == 0);
  }

  TEST_CASE("a walk goes on from the newest node, over free motions, to the node it returns") {
    for (const World& world : {threaded_world(), reaching_world()}) {
      INFO(world.name);
      EdgeLog log;
      PlanSettings settings = walking(1);
      settings.observer = &log;
      RunFixture f(world, settings);
      internal::EscapeWalk walk(f.run);
      internal::Tree tree(f.run, 1);
      int walked = 0;
      for (int i = 0; i < rounds(100); ++i) {
        if (i % 3 != 1) tree.add(f.run.start(), -1);
        const int before = tree.size();
        const std::size_t edges = log.edges.size();
        const std::vector<float> newest = values_of(tree.newest());
        const int last = walk.extend(tree);
        CHECK(last == (tree.size() == before ? -1 : tree.size() - 1));
        REQUIRE(log.edges.size() - edges == static_cast<std::size_t>(tree.size() - before));
        check_chain(f.checker, log, edges, newest);
        walked += tree.size() - before;
      }
      CHECK(walked > 100);
    }
  }

  TEST_CASE("steps pull a tip by at most a twentieth of the arm") {
    const World world{"open", thick_arm({1, 0.8, 0.6}), {}, {{0.4, 0.9, -1.1}, {{0, 0, 0}}}};
    const internal::FloatPath nodes = nodes_of_walks(world, walking(1), Isa::automatic, 50);
    REQUIRE(nodes.size() > 100);
    const auto tip_at = [&](const std::vector<float>& q) {
      const Configuration values(q.begin(), q.end());
      return world.robot.link_poses(values).back() * Vec3(0.6, 0, 0);
    };
    for (std::size_t i = 1; i < nodes.size(); ++i) {
      CHECK((tip_at(nodes[i]) - tip_at(nodes[i - 1])).norm() < 0.05 * 2.4 * 1.2);
    }
  }

  TEST_CASE("a walk from where no step is free adds nothing") {
    World world{"buried", thick_arm({1, 0.8, 0.6}), {}, {{0.4, 0.9, -1.1}, {{0, 0, 0}}}};
    world.scene = make_circle_scene("rock", {{1.5, 0, 5}});
    RunFixture f(world, walking(1));
    internal::EscapeWalk walk(f.run);
    internal::Tree tree(f.run);
    tree.add(f.run.start(), -1);
    for (int i = 0; i < 20; ++i) CHECK(walk.extend(tree) == -1);
    CHECK(tree.size() == 1);
  }

  TEST_CASE("a walk ends at the limit of nodes") {
    for (const std::uint64_t limit : {1, 2, 5, 20}) {
      PlanSettings settings = walking(1);
      settings.max_nodes = limit;
      RunFixture f(threaded_world(), settings);
      internal::EscapeWalk walk(f.run);
      internal::Tree tree(f.run);
      tree.add(f.run.start(), -1);
      for (int i = 0; i < 100; ++i) walk.extend(tree);
      CHECK(tree.size() == static_cast<int>(limit));
      CHECK(walk.extend(tree) == -1);
    }
  }

  TEST_CASE("a run that is cancelled does not walk") {
    const std::atomic<bool> is_cancelled = true;
    PlanSettings settings = walking(1);
    settings.cancel = &is_cancelled;
    RunFixture f(threaded_world(), settings);
    internal::EscapeWalk walk(f.run);
    internal::Tree tree(f.run);
    tree.add(f.run.start(), -1);
    CHECK(walk.extend(tree) == -1);
    CHECK(tree.size() == 1);
  }

  TEST_CASE("the same seed takes the same walks and another one others") {
    for (const Isa isa : available_isas()) {
      INFO(to_string(isa));
      PlanSettings settings = walking(1);
      const internal::FloatPath first = nodes_of_walks(threaded_world(), settings, isa, 20);
      CHECK(first == nodes_of_walks(threaded_world(), settings, isa, 20));
      settings.seed = 2;
      CHECK(first != nodes_of_walks(threaded_world(), settings, isa, 20));
    }
  }
}

TEST_SUITE("flow") {
  TEST_CASE("an arm threaded between posts gets out with walks in far fewer iterations") {
    const World world = threaded_world();
    for (const Isa isa : available_isas()) {
      const CollisionChecker checker = make_checker(world, RunFixture::of_isa(isa));
      const auto sampler = make_uniform_sampler(world.robot);
      std::uint64_t with = 0, without = 0;
      for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
        PlanSettings settings = patient_settings(seed);
        settings.max_iterations = 100000;
        const PlanResult walked = plan_with(rrt_connect, checker, world.query, *sampler, settings);
        check_solution(world, checker, walked);
        with += walked.iterations;
        settings.walk = 0;
        without += plan_with(rrt_connect, checker, world.query, *sampler, settings).iterations;
      }
      INFO(to_string(isa), ": ", with, " with and ", without, " without walks");
      CHECK(with * 10 < without);
    }
  }

  TEST_CASE("plans with walks repeat themselves with the same seed") {
    const World world = threaded_world();
    for (const Isa isa : available_isas()) {
      INFO(to_string(isa));
      const CollisionChecker checker = make_checker(world, RunFixture::of_isa(isa));
      const auto sampler = make_uniform_sampler(world.robot);
      PlanSettings settings = patient_settings(3);
      settings.walk = 0.5;
      const PlanResult first = plan_with(rrt_connect, checker, world.query, *sampler, settings);
      const PlanResult second = plan_with(rrt_connect, checker, world.query, *sampler, settings);
      REQUIRE(first.is_solved());
      CHECK(first.path == second.path);
      CHECK(first.iterations == second.iterations);
      CHECK(first.states_checked == second.states_checked);
    }
  }

  TEST_CASE("small worlds are solved whatever the share of walks") {
    for (const World& world : small_worlds()) {
      for (const double share : {0.0, 0.5, 0.9}) {
        INFO(world.name, ", share ", share);
        PlanSettings settings = patient_settings();
        settings.walk = share;
        settings.walk_after = 0;
        check_solution(world, make_checker(world), run(rrt_connect, world, settings));
      }
    }
  }

  TEST_CASE("a chain of too many joints for walks is planned for without them") {
    World world{"chain",
                chain_without_limbs(),
                {"", {make_box("post", {2.4, -0.1, -1}, {2.5, 0.1, 1})}},
                {Configuration(33, 0.05), {Configuration(33, -0.05)}}};
    PlanSettings settings = patient_settings();
    settings.walk = 1;
    settings.walk_after = 0;
    check_solution(world, make_checker(world), run(rrt_connect, world, settings));
  }
}

}  // namespace mneme::test
