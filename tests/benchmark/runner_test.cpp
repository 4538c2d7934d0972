// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "statistics/bench_support.h"
#include "support/no_threads.h"

namespace mneme {
namespace {

using test::contains;
using test::require_error;

/// Two problems, two planners and no kernel: what a run yields is made up by `answer`.
struct PretendedBench {
  BenchPlan plan;
  std::vector<BenchmarkRow> rows;

  explicit PretendedBench(std::function<PlanStatus(const BenchCase&)> answer) {
    for (const char* name : {"A", "B"}) {
      Problem problem = test::gap_problem();
      problem.name = name;
      plan.problems.push_back({"set", problem});
    }
    append_cases({}, {"one", "two"}, {"uniform"}, plan.cases);
    plan.solve = [answer](const Problem& problem, Database*, const BenchCase& bench_case) {
      SolveResult result;
      result.planner = bench_case.settings.planner;
      result.sampler = bench_case.settings.sampler;
      result.seed = bench_case.settings.plan.seed;
      result.plan.status = answer(bench_case);
      if (result.plan.is_solved()) result.plan.path = {problem.start, problem.goals[0]};
      return result;
    };
  }
  Result<bool> run(std::span<const BenchmarkRow> done = {}) {
    return run_bench(plan, done, [&](const BenchmarkRow& row, const SolveResult&) {
      rows.push_back(row);
      return Result<void>();
    });
  }
  [[nodiscard]] std::string order() const {
    std::string text;
    for (const BenchmarkRow& row : rows) {
      text += row.problem + row.planner.substr(0, 1) + std::to_string(row.seed) + " ";
    }
    return text;
  }
};

PlanStatus solve_all(const BenchCase&) { return PlanStatus::solved; }

TEST_SUITE("unit") {
  TEST_CASE("Runs of a problem follow each other, their order changes by seed and problem") {
    PretendedBench bench(solve_all);
    bench.plan.seed_count = 2;
    CHECK(bench.run().value());
    CHECK(bench.order() == "Ao1 At1 At2 Ao2 Bt1 Bo1 Bt2 Bo2 ");
    CHECK(describe_timing(bench.rows) == "warm");
  }

  TEST_CASE(
      "Warm runs have an untimed one before them, and rows of cold runs do not go with them") {
    int solved = 0;
    PretendedBench bench([&](const BenchCase&) {
      ++solved;
      return PlanStatus::solved;
    });
    CHECK(bench.run().value());
    CHECK(solved == 4 + 2);
    CHECK(check_same_settings(bench.plan, bench.rows).has_value());
    bench.plan.is_cold = true;
    CHECK(
        contains(require_error(check_same_settings(bench.plan, bench.rows)).message, "timed warm"));
    bench.rows.clear();
    solved = 0;
    CHECK(bench.run().value());
    CHECK(solved == 4);
    CHECK(describe_timing(bench.rows) == "cold");
  }

  TEST_CASE("Runs that learn are cold: they depend on those before them") {
    PretendedBench bench(solve_all);
    CHECK(bench.plan.is_warm());
    bench.plan.cases[1].settings.remember_after = 0;
    CHECK_FALSE(bench.plan.is_warm());
  }

  TEST_CASE("Cold, all problems with one seed come before the next, every other one in reverse") {
    PretendedBench bench(solve_all);
    bench.plan.is_cold = true;
    bench.plan.seed_count = 2;
    bench.plan.first_seed = 4;
    CHECK(bench.plan.run_count() == 8);
    CHECK(bench.run().value());
    CHECK(bench.order() == "Ao4 At4 Bo4 Bt4 At5 Ao5 Bt5 Bo5 ");
    const std::vector<BenchmarkRow> done(bench.rows.begin() + 1, bench.rows.end());
    bench.rows.clear();
    CHECK(bench.run(done).value());
    CHECK(bench.order() == "Ao4 ");
    bench.plan.alternates = false;
    bench.rows.clear();
    CHECK(bench.run().value());
    CHECK(bench.order() == "Ao4 At4 Bo4 Bt4 Ao5 At5 Bo5 Bt5 ");
  }

  TEST_CASE("A case that gets nowhere is not run further") {
    PretendedBench bench([](const BenchCase& bench_case) {
      return bench_case.settings.planner == "one" ? PlanStatus::timeout : PlanStatus::solved;
    });
    bench.plan.seed_count = 5;
    bench.plan.hopeless_after = 2;
    CHECK(bench.run().value());
    const auto failed = std::ranges::count(bench.rows, std::string("one"), &BenchmarkRow::planner);
    CHECK(failed == 4);
    CHECK(bench.rows.size() == 14);
  }

  TEST_CASE("A cancelled run leaves no row and ends the benchmark, and so does an error") {
    PretendedBench cancelled([](const BenchCase& bench_case) {
      return bench_case.settings.planner == "two" ? PlanStatus::cancelled : PlanStatus::solved;
    });
    CHECK_FALSE(cancelled.run().value());
    CHECK(cancelled.order() == "Ao1 ");
    PretendedBench bench(solve_all);
    const auto refuse = [](const BenchmarkRow&, const SolveResult&) -> Result<void> {
      return fail(ErrorCode::io, "full");
    };
    CHECK(run_bench(bench.plan, {}, refuse).error().message == "full");
  }

  TEST_CASE("One thread does all runs where others are refused") {
    PretendedBench bench(solve_all);
    bench.plan.jobs = 3;
    const test::NoThreads none;
    CHECK(bench.run().value());
    CHECK(bench.rows.size() == 4);
  }

  TEST_CASE("Serial planners take their turns beside others, each run once") {
    PretendedBench bench(solve_all);
    bench.plan.cases[0].is_serial = true;
    bench.plan.seed_count = 20;
    bench.plan.jobs = 3;
    std::atomic<int> running = 0;
    std::atomic<bool> is_alone = true;
    bench.plan.solve = [&, solve = bench.plan.solve](const Problem& problem, Database* database,
                                                     const BenchCase& bench_case) {
      const bool is_serial = bench_case.settings.planner == "one";
      if (is_serial && ++running > 1) is_alone = false;
      auto result = solve(problem, database, bench_case);
      if (is_serial) --running;
      return result;
    };
    CHECK(bench.run().value());
    CHECK(is_alone);
    CHECK(bench.rows.size() == 80);
    sort_rows(bench.plan, bench.rows);
    CHECK(bench.order().starts_with("Ao1 At1 At2 Ao2 At3 "));
  }

  TEST_CASE("Each planner meets each sampler, in the order of their names; some take turns") {
    PlannerEntry alone;
    alone.name = "alone";
    alone.is_exclusive = true;
    add_planners({alone});
    BenchCase setting;
    setting.setting = "tuned";
    setting.settings.lambda = 0.25;
    std::vector<BenchCase> cases(1);
    append_cases(setting, {"rrt", "alone"}, {"uniform", "gl"}, cases);
    std::string names;
    for (const BenchCase& added : std::span(cases).subspan(1)) {
      CHECK(added.setting == "tuned");
      CHECK(added.settings.lambda == 0.25);
      CHECK(added.is_serial == (added.settings.planner == "alone"));
      names += added.settings.planner + " " + added.settings.sampler + ", ";
    }
    CHECK(names == "rrt uniform, rrt gl, alone uniform, alone gl, ");
  }
}

}  // namespace
}  // namespace mneme
