// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/query.h"
#include "support/planar_memory.h"

namespace mneme::test {
namespace {

using internal::kAlone;

/// An arm, and a memory of whole paths that the settings leave alone.
struct Remembering {
  Problem problem;
  TemporaryDirectory directory;
  Database database = make_database(directory / "m.db", problem.robot);
  SolveSettings settings;

  explicit Remembering(Problem new_problem) : problem(std::move(new_problem)) {
    settings.remember_after = 0;
    settings.plan.timeout_s = 600;
  }
  SolveResult solve(Database* memory) {
    auto result = require(mneme::solve(problem, memory, settings));
    REQUIRE(database.flush());
    return result;
  }
  SolveResult solve() { return solve(&database); }
  /// Stores a path of this problem that seems to have been hard to find.
  void remember(const Path& path, std::uint64_t planning_states = 100'000) {
    auto rows =
        require(learn_from_paths(memory_query(problem), std::vector<Path>{path}, {"paths", {}}));
    rows.front().path().planning_states = planning_states;
    require(database.insert(std::move(rows)));
  }
};

/// Planned in a few iterations.
Problem quick_problem() {
  Problem problem{.name = "easy",
                  .robot = limited_arm({1, 1}, -0.5, 2.5),
                  .start = {0, 0.5},
                  .goals = {{2, 0.5}}};
  problem.scene = make_circle_scene("easy", {{0.5, 0.9, 0.3}});
  return problem;
}

Problem long_problem() { return planar_problem("threaded_b4"); }

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE("a task that is planned at once neither asks nor fills the memory") {
    Remembering easy(quick_problem());
    const SolveResult alone = easy.solve(nullptr);
    REQUIRE(alone.plan.iterations > 0);
    REQUIRE(alone.plan.iterations < kAlone);
    easy.remember(alone.plan.path);
    const SolveResult result = easy.solve();
    CHECK(result.plan.path == alone.plan.path);
    CHECK(result.plan.states_checked == alone.plan.states_checked);
    CHECK(result.replay.keys == 0);
    CHECK(result.replay.time_s == 0);
    CHECK_FALSE(result.remembered.is_queued);
    easy.settings.replay = 0.5;
    CHECK(easy.solve().replay.is_hit());
  }

  TEST_CASE("a search that takes a while asks, and ends with the replayed path") {
    for (const int threads : {1, 3}) {
      Remembering hard(long_problem());
      hard.settings.threads = threads;
      hard.settings.remember_after.reset();
      const SolveResult first = hard.solve();
      REQUIRE(first.plan.is_solved());
      REQUIRE(first.plan.iterations > kAlone);
      hard.remember(first.plan.path);
      const SolveResult second = hard.solve();
      REQUIRE(second.plan.is_solved());
      CHECK(second.replay.row == hard.database.get(0)->id);
      CHECK(second.plan.iterations == kAlone);
      CHECK(second.plan.states_checked > second.replay.states);
      CHECK(second.plan.states_checked < first.plan.states_checked);
      CHECK(is_path_free(hard.problem.robot, hard.problem.scene, second.plan.path, 0.002));
      hard.settings.replay = 0.5;
      const SolveResult named = hard.solve();
      CHECK(named.plan.iterations == 0);
      CHECK(named.plan.path == second.plan.path);
    }
  }

  TEST_CASE("a search that ends before it is due to ask does so at last, and all time counts") {
    Remembering hard(long_problem());
    hard.settings.remember_after.reset();
    const SolveResult first = hard.solve();
    hard.remember(first.plan.path);
    hard.settings.plan.max_iterations = 10;
    const SolveResult second = hard.solve();
    REQUIRE(second.replay.is_hit());
    CHECK(second.plan.iterations == 10);
    const PlanResult& plan = second.plan;
    CHECK(plan.planning_time_s + plan.simplification_time_s + plan.verification_time_s >
          second.replay.time_s);
  }

  TEST_CASE("asking in vain leaves the search as it was") {
    Remembering hard(long_problem());
    const SolveResult alone = hard.solve(nullptr);
    Path elsewhere = alone.plan.path;
    for (Configuration& q : elsewhere) q[1] += 1.2;
    hard.remember(elsewhere);
    hard.settings.retrieve_after = 1'000'000'000;
    const SolveResult result = hard.solve();
    CHECK_FALSE(result.replay.is_hit());
    CHECK(result.replay.keys > 0);
    CHECK(result.plan.path == alone.plan.path);
    CHECK(result.plan.iterations == alone.plan.iterations);
    CHECK(result.plan.states_checked == alone.plan.states_checked + result.replay.states);
  }

  TEST_CASE("memory that has paid is asked before the search, until it no longer pays") {
    Remembering easy(quick_problem());
    const SolveResult alone = easy.solve(nullptr);
    easy.remember(alone.plan.path);
    easy.database.book("paths/1", 0, 10'000);
    const SolveResult paying = easy.solve();
    CHECK(paying.replay.is_hit());
    CHECK(paying.plan.iterations == 0);
    easy.database.book("paths/1", 1'000'000, 0);
    CHECK(easy.solve().replay.keys == 0);
    easy.settings.remember_after.reset();  // such a query does not depend on earlier ones
    easy.database.book("paths/1", 0, 2'000'000);
    CHECK(easy.solve().replay.keys == 0);
  }
}

}  // namespace mneme::test
