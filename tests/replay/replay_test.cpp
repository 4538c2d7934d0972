// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "replay/replay.h"
#include "path/push_off.h"
#include "support/deformation.h"
#include "support/path_cell.h"

#include <atomic>

namespace mneme::test {
namespace {

/// An arm of two links that turns from `start` to `goal` past circles, and knows the straight way.
struct Cell : PathCell {
  using PathCell::remember;
  void remember(std::optional<std::uint64_t> planning_states = {}) {
    remember({problem.start, problem.goals.front()}, planning_states);
  }
  void put(const std::vector<std::array<double, 3>>& circles) {
    problem.scene = make_circle_scene("cell", circles);
  }
  SolveResult solve() { return require(mneme::solve(problem, &database, settings)); }
  [[nodiscard]] bool is_verified(const Path& path) const {
    const CollisionChecker checker = make_checker(problem.robot, problem.scene);
    CheckCounters counters;
    return !path.empty() && find_invalid_motion(checker, path, counters) < 0;
  }
};

/// Beside the middle of the way that Cell knows, which the tip of the arm touches.
const std::array<double, 3> kBeside = {1.95 * std::cos(1.25), 1.95 * std::sin(1.25), 0.05};

/// Across all of that way, and the other way round.
std::vector<std::array<double, 3>> wall() {
  std::vector<std::array<double, 3>> circles;
  for (const double angle : {1.25, -1.8}) {
    for (double r = 0.2; r < 2.2; r += 0.15) {
      circles.push_back({r * std::cos(angle), r * std::sin(angle), 0.08});
    }
  }
  return circles;
}

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE("a task of a static cell is planned once, remembered, and replayed from then on") {
    Problem problem = planar_problem("threaded_b4");
    const TemporaryDirectory directory;
    Database database = make_database(directory / "m.db", problem.robot);
    SolveSettings settings;
    settings.memory.kind = "paths";
    settings.replay = 0.5;
    settings.remember_after = 0;
    const SolveResult first = solve(problem, &database, settings).value();
    CHECK_FALSE(first.replay.is_hit());
    CHECK_FALSE(first.replay.nearest.has_value());
    CHECK(first.replay.time_s > 0);
    REQUIRE(first.remembered.is_queued);
    REQUIRE(database.flush());
    const SolveResult second = solve(problem, &database, settings).value();
    REQUIRE(second.plan.is_solved());
    CHECK(second.replay.row == database.get(0)->id);
    CHECK(second.replay.distance < 1e-5);
    CHECK_FALSE(second.replay.is_repaired);
    CHECK(second.plan.iterations == 0);
    CHECK(!second.remembered.is_queued);
    CHECK(database.size() == 1);
    CHECK(database.get(0)->path().planning_states == first.plan.states_checked);
    CHECK(is_path_free(problem.robot, problem.scene, second.plan.path, 0.002));
  }
}

TEST_SUITE("unit") {
  TEST_CASE("a replayed path begins at the turn of the start and is continuous") {
    Cell cell;
    cell.remember({{2, 0.5}, {3, 1.5}, {-2.5, 0.5}});
    cell.problem.start = {2 + 2 * kPi, 0.5};
    cell.problem.goals = {{-2.5, 0.5}};
    const SolveResult result = cell.solve();
    REQUIRE(result.replay.is_hit());
    const Path& path = result.plan.path;
    CHECK(path.front() == cell.problem.start);
    for (std::size_t i = 1; i < path.size(); ++i)
      CHECK(std::abs(path[i][0] - path[i - 1][0]) < kPi);
    CHECK(path.back()[0] == doctest::Approx(4 * kPi - 2.5));
    CHECK(cell.is_verified(path));
  }

  TEST_CASE("tasks are remembered and replayed whatever the planner draws from") {
    Cell cell;
    cell.put({{0.5, 0.9, 0.3}});
    cell.settings.sampler = "uniform";
    cell.settings.remember_after = 0;
    CHECK(cell.solve().remembered.is_queued);
    REQUIRE(cell.database.flush());
    CHECK(cell.solve().replay.is_hit());
    CHECK(cell.database.size() == 1);
  }

  TEST_CASE("a known path is bent to the ends of the query, which it keeps exactly") {
    Cell cell;
    cell.remember({{0, 0.5}, {1, 1.5}, {2, 0.5}});
    cell.problem.start = {0.1, 0.5};
    cell.problem.goals = {{-0.3, 2}, {2, 0.4}};
    const SolveResult result = cell.solve();
    REQUIRE(result.replay.is_hit());
    const Path& path = result.plan.path;
    REQUIRE(path.size() == 5);
    CHECK(path.front() == Configuration{0.1, 0.5});
    CHECK(path[2][0] == doctest::Approx(1));
    CHECK(path[2][1] == doctest::Approx(1.5));
    CHECK(path.back() == Configuration{2, 0.4});
    CHECK(result.replay.distance > 0.1);
    CHECK(result.replay.distance < 0.3);
  }

  TEST_CASE("a known path serves the way back, too") {
    Cell cell;
    cell.remember({{0, 0.5}, {1, 1.5}, {2, 0.5}});
    std::swap(cell.problem.start, cell.problem.goals.front());
    const SolveResult result = cell.solve();
    REQUIRE(result.replay.is_hit());
    CHECK(result.plan.path.size() == 3);
    CHECK(result.plan.path.front() == cell.problem.start);
  }

  TEST_CASE("a path that is blocked is led round what blocks it, always the same way") {
    Cell cell;
    cell.remember();
    cell.put({kBeside});
    const SolveResult result = cell.solve();
    REQUIRE(result.replay.is_hit());
    CHECK(result.replay.is_repaired);
    REQUIRE(result.replay.blocked.size() == 1);
    CHECK(result.replay.blocked.front().fraction > 0.3);
    CHECK(result.replay.blocked.front().fraction < 0.6);
    CHECK(cell.is_verified(result.plan.path));
    const SolveResult again = cell.solve();
    CHECK(again.plan.path == result.plan.path);
    CHECK(again.plan.states_checked == result.plan.states_checked);
  }

  TEST_CASE("what leads round something goes the same way as the path that is remembered") {
    Cell cell;
    cell.remember();
    const Scene before =
        make_circle_scene("cell", {{2.1 * std::cos(1.25), 2.1 * std::sin(1.25), 0.05}});
    cell.put({kBeside});
    const SolveResult result = cell.solve();
    REQUIRE(result.replay.is_repaired);
    const Path known = {cell.problem.start, cell.problem.goals.front()};
    CHECK(
        Deformation(cell.problem.robot, before, cell.problem.scene).find(known, result.plan.path));
  }

  TEST_CASE("a way that leads far round what blocks a path is planned, not replayed") {
    Cell cell;
    cell.remember();
    cell.put({{1.4 * std::cos(1.25), 1.4 * std::sin(1.25), 0.3}});
    const SolveResult result = cell.solve();
    CHECK_FALSE(result.replay.is_hit());
    CHECK(result.replay.iterations > 0);
    REQUIRE(result.plan.is_solved());
    CHECK(result.plan.path.size() > 2);
  }

  TEST_CASE("paths on either side of an obstacle do not lead into each other") {
    const Robot robot = limited_arm({1, 1}, -2.6, 2.6);
    const Scene scene = make_circle_scene("post", {{1.9, 0, 0.1}});
    const Path above = {{0.8, 0}, {0.6, 2.2}, {-0.6, 2.2}, {-0.8, 0}};
    const Path below = {{0.8, 0}, {0.6, -2.2}, {-0.6, -2.2}, {-0.8, 0}};
    const Path higher = {{0.8, 0}, {0.6, 2.4}, {-0.7, 2.3}, {-0.8, 0.1}};
    CHECK(Deformation(robot, scene, scene).find(above, higher));
    CHECK_FALSE(Deformation(robot, scene, scene).find(above, below));
  }

  TEST_CASE("where no way round is found planning goes on, and the result says what was tried") {
    Cell cell;
    cell.remember();
    cell.put(wall());
    cell.settings.plan.max_iterations = 300;
    const SolveResult result = cell.solve();
    CHECK_FALSE(result.replay.is_hit());
    CHECK(result.plan.status == PlanStatus::iteration_limit);
    CHECK(result.plan.iterations == 300);
    CHECK(result.replay.iterations > 0);
    REQUIRE(result.replay.blocked.size() == 1);
    const BlockedPath& blocked = result.replay.blocked.front();
    CHECK(blocked.row == cell.database.get(0)->id);
    CHECK(blocked.fraction > 0.2);
    CHECK(blocked.fraction < 0.6);
    const CollisionChecker checker = make_checker(cell.problem.robot, cell.problem.scene);
    CHECK_FALSE(checker.is_valid(std::span<const double>(blocked.state)));
  }

  TEST_CASE("a task that is not near enough is told, and left alone") {
    Cell cell;
    cell.remember();
    cell.problem.goals = {{1, 0.5}};
    const SolveResult result = cell.solve();
    CHECK(result.plan.is_solved());
    CHECK_FALSE(result.replay.is_hit());
    CHECK(result.replay.blocked.empty());
    REQUIRE(result.replay.nearest.has_value());
    CHECK(*result.replay.nearest > 0.5);
    CHECK(*result.replay.nearest < 1.5);
    cell.settings.replay = 2;
    CHECK(cell.solve().replay.is_hit());
  }

  TEST_CASE("replaying can be turned off, and is refused of a kind that has no whole paths") {
    Cell cell;
    cell.remember();
    cell.settings.replay = 0;
    CHECK(cell.solve().replay.time_s == 0);
    cell.settings.replay = 0.5;
    cell.settings.memory.kind = "pairs";
    const Error refused = require_error(solve(cell.problem, &cell.database, cell.settings));
    CHECK(refused.message ==
          "setting 'replay': memory of the kind 'pairs' holds no whole paths, expected the kind "
          "paths");
  }

  TEST_CASE("tasks are remembered and replayed beside rows of other kinds") {
    Cell cell;
    learn_into(cell.database, cell.problem.robot, {{1, 0.6, 0.3, 1, -0.6, 0.3}});
    cell.settings.memory.kind.reset();
    cell.settings.remember_after = 0;
    cell.put({{0.5, 0.9, 0.3}});
    CHECK_FALSE(cell.solve().replay.is_hit());
    REQUIRE(cell.database.flush());
    CHECK(cell.solve().replay.is_hit());
  }

  TEST_CASE("a distance below 0 is refused by name") {
    Cell cell;
    cell.settings.replay = -1;
    const Error refused = require_error(solve(cell.problem, &cell.database, cell.settings));
    CHECK(contains(refused.message, "replay"));
  }
}

TEST_SUITE("law") {
  TEST_CASE("nothing comes back that is not verified, even where plans need not be") {
    for (const bool verify : {true, false}) {
      Cell cell;
      cell.remember();
      cell.settings.plan.verify = verify;
      Rng rng(5);
      for (int i = 0; i < 60; ++i) {
        const double r = rng.uniform(1.2, 2), angle = rng.uniform(0.6, 1.9);
        cell.put({{r * std::cos(angle), r * std::sin(angle), rng.uniform(0.02, 0.2)}});
        const SolveResult result = cell.solve();
        if (!result.replay.is_hit()) continue;
        CHECK(is_path_free(cell.problem.robot, cell.problem.scene, result.plan.path, 0.002));
      }
    }
  }

  TEST_CASE("a miss looks at a bounded number of tasks, however many are known") {
    Cell cell;
    Rng rng(3);
    std::vector<Path> paths;
    for (int i = 0; i < 4000; ++i) {
      const double turn = rng.uniform(1.6, 1.7);
      paths.push_back({{rng.uniform(-0.5, 2.5), turn}, {rng.uniform(-0.5, 2.5), turn}});
    }
    auto rows = learn_from_paths(memory_query(cell.problem), paths, {"paths", {}});
    require(cell.database.insert(*std::move(rows)));
    const SolveResult missed = cell.solve();
    CHECK_FALSE(missed.replay.is_hit());
    REQUIRE(missed.replay.nearest.has_value());
    CHECK(*missed.replay.nearest > 1.1);
    CHECK(missed.replay.keys > 0);
    CHECK(missed.replay.keys <= 2 * (1024 + 64));
    cell.problem.start = paths.back().front();
    cell.problem.goals = {paths.back().back()};
    const SolveResult known = cell.solve();
    CHECK(known.replay.is_hit());
    CHECK(known.replay.distance < 1e-5);
    CHECK(known.replay.keys <= 1024 + 64);
  }

  TEST_CASE("what fails costs no more however hard the query is") {
    Cell cell;
    cell.remember();
    cell.put(wall());
    std::uint64_t least = 0;
    for (const std::uint64_t iterations : {1, 400, 1000}) {
      cell.settings.plan.max_iterations = iterations;
      cell.settings.replay = 0;
      const SolveResult without = cell.solve();
      cell.settings.replay = 0.5;
      const SolveResult with = cell.solve();
      CHECK(with.plan.iterations == without.plan.iterations);
      const std::uint64_t cost = with.plan.states_checked - without.plan.states_checked;
      CHECK(cost < 20000);
      if (iterations == 400) least = cost;
      if (iterations == 1000) CHECK(cost == least);
    }
  }

  TEST_CASE("a path that planning finds with fewer states than its check takes is planned") {
    Cell cell;
    cell.remember(50);
    CHECK(cell.solve().replay.cheap_row.has_value());
    Cell hard;
    hard.remember(1000);
    CHECK(hard.solve().replay.is_hit());
  }

  TEST_CASE("a repair costs at most half of what planning has cost, and a step") {
    std::vector<std::uint64_t> iterations;
    for (const std::uint64_t cost : {500, 8000, 1000000}) {
      Cell cell;
      cell.put(wall());
      cell.remember(cost);
      cell.settings.plan.max_iterations = 300;
      cell.settings.replay = 0;
      const SolveResult without = cell.solve();
      cell.settings.replay = 0.5;
      const SolveResult with = cell.solve();
      CHECK(with.plan.states_checked - without.plan.states_checked < cost / 2 + 4000);
      iterations.push_back(with.replay.iterations);
    }
    CHECK(iterations[0] <= 500 / 8 / 64);
    CHECK(iterations[1] > iterations[0]);
    CHECK(iterations[1] <= 8000 / 8 / 64);
    CHECK(iterations[2] == 200);
  }

  TEST_CASE("a stretch is pushed off what it touches and keeps its ends, or is given up") {
    Cell cell;
    cell.put({kBeside});
    const CollisionChecker checker = make_checker(cell.problem.robot, cell.problem.scene);
    CheckCounters counters;
    const Path path = {{0.5, 0.5}, {1.5, 0.5}};
    const Path pushed = internal::push_off(checker, path, counters);
    REQUIRE(pushed.size() > 2);
    CHECK(pushed.front() == path.front());
    CHECK(pushed.back() == path.back());
    CHECK_FALSE(checker.is_valid(std::span<const double>(Configuration{1.0, 0.5})));
    for (const Configuration& q : pushed) CHECK(checker.is_valid(std::span<const double>(q)));
    CHECK(counters.states > 0);
    cell.put(wall());
    const CollisionChecker blocked = make_checker(cell.problem.robot, cell.problem.scene);
    CHECK(internal::push_off(blocked, path, counters).empty());
  }

  TEST_CASE("a widened path keeps its ends, stays free and is farther from obstacles") {
    Cell cell;
    const Path path = {{0, 0.5}, {2, 0.5}};
    cell.put({{2.043 * std::cos(1.25), 2.043 * std::sin(1.25), 0.1}});
    const CollisionChecker checker = make_checker(cell.problem.robot, cell.problem.scene);
    REQUIRE(cell.is_verified(path));
    const Path widened = internal::widen(checker, path, {});
    CHECK(widened.front() == path.front());
    CHECK(widened.back() == path.back());
    CHECK(cell.is_verified(widened));
    const CollisionChecker wide = make_checker(cell.problem.robot, cell.problem.scene, 0.01);
    CheckCounters counters;
    CHECK(find_invalid_motion(wide, path, counters) >= 0);
    CHECK(find_invalid_motion(wide, widened, counters) < 0);
    const std::atomic<bool> is_cancelled = true;
    FinishSettings cancelled;
    cancelled.cancel = &is_cancelled;
    CHECK(internal::widen(checker, path, cancelled) == path);
  }

  TEST_CASE("a query that is cancelled looks for no known task") {
    Cell cell;
    cell.remember();
    std::atomic<bool> is_cancelled = false;
    PlanSettings settings;
    settings.cancel = &is_cancelled;
    const CollisionChecker checker = make_checker(cell.problem.robot, cell.problem.scene);
    const MemoryQuery query = memory_query(cell.problem);
    const PlanQuery ends{cell.problem.start, cell.problem.goals};
    const auto replayed = [&] {
      Replay report;
      static_cast<void>(internal::replay({cell.database, *find_memory_kind("paths").value(), 0, 0.5,
                                          query, ends, checker, nullptr, settings},
                                         report));
      return report;
    };
    CHECK(replayed().keys > 0);
    is_cancelled = true;
    CHECK(replayed().keys == 0);
  }
}

}  // namespace mneme::test
