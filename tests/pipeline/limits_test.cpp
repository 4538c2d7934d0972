// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Times are those of the thread that plans, on the processor: on a busy machine a thread may wait
// for long, but it never works for longer than it would alone.
#include "support/planar_memory.h"

#include <atomic>
#include <thread>
#include <pthread.h>
#include <time.h>

namespace mneme::test {
namespace {

constexpr double kSlack = 0.010 * kSlowdown;
constexpr int kTries = 5;

double seconds(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}
double own_seconds() { return seconds(CLOCK_THREAD_CPUTIME_ID); }

struct HardProblem {
  std::string name;
  Problem problem;
  double learn_budget_s = 0;
};

/// A first link between posts all around it: nothing leads from start to goal.
std::vector<HardProblem> unsolvable_problems() {
  std::vector<std::array<double, 3>> ring;
  for (int i = 0; i < 18; ++i) {
    const double angle = i * kPi / 9;
    if (i != 0 && i != 9) ring.push_back({0.8 * std::cos(angle), 0.8 * std::sin(angle), 0.2});
  }
  Problem planar = planar_problem("scenario1");
  planar.scene = make_circle_scene("ring", ring);
  planar.start = {-kPi, 0.5, 0.2, -0.3, 0.4, -0.2, 0.3, 0.1};
  planar.goals = {{0, 0.3, 0.3, -0.3, 0.4, -0.2, 0.3, 0.1}};
  return {{"planar", planar, 0}, {"planar that learns", planar, 10}};
}

SolveSettings settings_for(const HardProblem& hard, std::string_view planner,
                           std::string_view sampler) {
  SolveSettings settings;
  settings.planner = planner;
  settings.sampler = sampler;
  settings.retrieve_after = 0;
  settings.learn_budget_s = hard.learn_budget_s;
  settings.learn.starts_per_link = 1000;
  settings.similarity = 1e-9;
  return settings;
}

/// Calls `look(hard, settings, database)` for every problem, planner and sampler.
template <class Look>
void for_all(const Look& look) {
  const TemporaryDirectory directory;
  for (const HardProblem& hard : unsolvable_problems()) {
    Database database = make_database(directory / (hard.name + ".db"), hard.problem.robot);
    for (const PlannerEntry& planner : planners()) {
      for (const std::string_view sampler : {"gl", "uniform", "halton"}) {
        if (hard.learn_budget_s > 0 && sampler != "gl") continue;
        INFO(hard.name, " ", planner.name, " ", sampler);
        look(hard, settings_for(hard, planner.name, sampler), database);
      }
    }
  }
}

/// Seconds of work after the time limit.
double overtime(const Problem& problem, Database& database, const SolveSettings& settings) {
  const double start = own_seconds();
  const auto result = require(solve(problem, &database, settings));
  const double worked = own_seconds() - start;
  REQUIRE(result.plan.status == PlanStatus::timeout);
  return worked - settings.plan.timeout_s;
}

/// Seconds of work after a cancellation that comes when the planner has worked for 20 ms.
double work_after_cancel(const Problem& problem, Database& database, SolveSettings settings) {
  std::atomic<bool> is_cancelled = false;
  std::atomic<bool> may_end = false;
  settings.plan.cancel = &is_cancelled;
  settings.plan.timeout_s = 60;
  double end = 0;
  PlanStatus status = PlanStatus::solved;
  std::thread planner([&] {
    if (const auto result = solve(problem, &database, settings)) status = result->plan.status;
    end = own_seconds();
    while (!may_end) std::this_thread::yield();
  });
  clockid_t clock{};
  pthread_getcpuclockid(planner.native_handle(), &clock);
  while (seconds(clock) < 0.020) std::this_thread::yield();
  is_cancelled = true;
  const double cancelled = seconds(clock);
  may_end = true;
  planner.join();
  REQUIRE(status == PlanStatus::cancelled);
  return end - cancelled;
}

TEST_SUITE("flow") {
  TEST_CASE("no planner works on for ten milliseconds after its time limit, learning included") {
    for_all([](const HardProblem& hard, SolveSettings settings, Database& database) {
      settings.plan.timeout_s = 0.030;
      double least = 1e9;
      for (int i = 0; i < kTries && least > kSlack; ++i) {
        least = std::min(least, overtime(hard.problem, database, settings));
      }
      CHECK(least <= kSlack);
    });
  }

  TEST_CASE("a cancelled planner works on for less than ten milliseconds, learning included") {
    for_all([](const HardProblem& hard, const SolveSettings& settings, Database& database) {
      double least = 1e9;
      for (int i = 0; i < kTries && least > kSlack; ++i) {
        least = std::min(least, work_after_cancel(hard.problem, database, settings));
      }
      CHECK(least <= kSlack);
    });
  }
}

}  // namespace
}  // namespace mneme::test
