// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "demo_cell.h"

#include "mneme/check.h"
#include "mneme/instances.h"
#include "mneme/pipeline.h"

#include "console.h"
#include "demo_finding.h"

#include <fmt/format.h>

#include <algorithm>

namespace mneme::app {
namespace {

constexpr RepeatSettings kOtherTask = {0, 0.06};
constexpr RepeatSettings kRepetition = {0.01, 0.01};
constexpr double kReplay = 0.5;       // radians
constexpr double kImprovement = 0.1;  // seconds for each stored path
constexpr double kCheckStep = 0.01;   // radians
constexpr int kFractions = 32;

struct Task {
  Problem problem;
  Path path;
};

SolveSettings planning(std::uint64_t seed) {
  SolveSettings settings;
  settings.sampler = "uniform";
  settings.plan.seed = seed;
  settings.plan.cancel = interrupt_flag();
  return settings;
}

SolveSettings replaying(std::uint64_t seed) {
  SolveSettings settings = planning(seed);
  settings.sampler = "gl";
  settings.replay = kReplay;
  return settings;
}

/// Plans a task into the memory; without a path if it has none.
Result<Task> remember(Problem problem, std::uint64_t seed, Database& memory) {
  SolveSettings settings = replaying(seed);
  settings.replay = 0;  // each task has a path of its own
  settings.remember_after = 0;
  settings.plan.improve = kImprovement;
  const SolveResult result = MNEME_TRY(solve(problem, &memory, settings));
  MNEME_TRY(memory.flush());
  return Task{std::move(problem), result.plan.path};
}

/// Another query of the memory: a repetition of `task`.
Result<void> repeat_task(const Task& task, std::uint64_t seed, Database& memory, CellRuns& runs) {
  Rng rng(seed);
  const Problem problem = MNEME_TRY(repeat(task.problem, kRepetition, rng));
  const SolveResult planned = MNEME_TRY(solve(problem, nullptr, planning(seed)));
  const SolveResult replayed = MNEME_TRY(solve(problem, &memory, replaying(seed)));
  if (!planned.plan.is_solved() || !replayed.plan.is_solved()) {
    ++runs.unsolved;
    return {};
  }
  for (const SolveResult* result : {&planned, &replayed}) {
    const Scene scene = checked_scene(problem, *result);
    runs.wrong += is_path_free(problem.robot, scene, result->plan.path, kCheckStep) ? 0 : 1;
  }
  const auto deviation = [&](const SolveResult& result) {
    return path_deviation(problem.robot, task.path, result.plan.path);
  };
  runs.repeats.push_back({planned.total_time_s, replayed.total_time_s, deviation(planned),
                          deviation(replayed), replayed.replay.is_hit()});
  return {};
}

/// The configuration at each of kFractions + 1 equal fractions of a path's length.
std::vector<Configuration> resample(const Robot& robot, const Path& path) {
  std::vector<double> travelled = {0};
  for (std::size_t i = 1; i < path.size(); ++i) {
    travelled.push_back(travelled.back() + robot.distance(path[i - 1], path[i]));
  }
  std::vector<Configuration> states;
  std::size_t next = 1;
  for (int i = 0; i <= kFractions; ++i) {
    const double wanted = travelled.back() * i / kFractions;
    while (next + 1 < path.size() && travelled[next] < wanted) ++next;
    const double length = travelled[next] - travelled[next - 1];
    const double fraction = length > 0 ? (wanted - travelled[next - 1]) / length : 0;
    const Configuration step = robot.difference(path[next - 1], path[next]);
    Configuration& state = states.emplace_back(path[next - 1]);
    for (std::size_t j = 0; j < state.size(); ++j) state[j] += std::min(fraction, 1.0) * step[j];
  }
  return states;
}

template <class Member>
double median_of(const std::vector<RepeatedTask>& repeats, Member member) {
  std::vector<double> values;
  for (const RepeatedTask& repeated : repeats) values.push_back(repeated.*member);
  return median(std::move(values));
}

}  // namespace

double path_deviation(const Robot& robot, const Path& a, const Path& b) {
  if (a.size() < 2 || b.size() < 2) return 0;
  const std::vector<Configuration> first = resample(robot, a), second = resample(robot, b);
  double largest = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    largest = std::max(largest, robot.distance(first[i], second[i]));
  }
  return largest;
}

Result<CellRuns> run_cell(const Problem& base, int tasks, int repeats, std::uint64_t seed,
                          Database& memory) {
  CellRuns runs;
  std::vector<Task> known;
  Progress progress("repeating tasks");
  for (int i = 1; i <= tasks && !interrupt_flag()->load(); ++i) {
    Rng rng(derive_seed(seed, static_cast<std::uint64_t>(i)));
    Problem problem = MNEME_TRY(repeat(base, kOtherTask, rng));
    problem.name = fmt::format("task {}", i);
    Task task = MNEME_TRY(remember(std::move(problem), seed, memory));
    if (task.path.size() < 2) continue;
    if (runs.longest.empty() ||
        path_length(base.robot, task.path) > path_length(base.robot, runs.longest)) {
      runs.longest = task.path;
      runs.shown = task.problem;
    }
    known.push_back(std::move(task));
  }
  runs.tasks = static_cast<int>(known.size());
  for (int i = 1; i <= repeats && !interrupt_flag()->load(); ++i) {
    for (std::size_t task = 0; task < known.size(); ++task) {
      const std::uint64_t own = derive_seed(derive_seed(seed, task), static_cast<std::uint64_t>(i));
      MNEME_TRY(repeat_task(known[task], own, memory, runs));
    }
    progress.update(i, repeats);
  }
  return runs;
}

std::string describe_cell(const std::string& robot, const CellRuns& runs) {
  if (runs.repeats.empty()) return "";
  const auto replays = std::ranges::count_if(runs.repeats, &RepeatedTask::is_replayed);
  const double planned = 1e3 * median_of(runs.repeats, &RepeatedTask::planned_s);
  const double replayed = 1e3 * median_of(runs.repeats, &RepeatedTask::replayed_s);
  std::string text = fmt::format(
      "In a cell, {} repeats {} tasks with obstacles and goals moved by up to 1 cm. From the call "
      "to the proven path, {}. {} of {} repetitions were replayed, the others planned.",
      robot, runs.tasks, compare_times(planned, replayed), replays, runs.repeats.size());
  text += fmt::format(
      " Paths repeat: at the median, a path from memory stays within {:.2g} rad of the first path "
      "of its task, a planned one within {:.2g} rad.\n\n",
      median_of(runs.repeats, &RepeatedTask::replayed_deviation),
      median_of(runs.repeats, &RepeatedTask::planned_deviation));
  return text;
}

}  // namespace mneme::app
