// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmark/suite_memories.h"

#include "mneme/baselines.h"

#include "base/fail.h"
#include "base/threads.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>

namespace mneme::internal {
namespace {

void say(const SuiteHooks& hooks, const std::string& note) {
  if (hooks.on_note) hooks.on_note(note);
}

void watch(const SuiteHooks& hooks, const std::string& what, LearnRun& run) {
  run.cancel = hooks.cancel;
  if (hooks.watch) hooks.watch(run, what);
}

Result<void> open_for_robots(const std::string& name, const std::string& path, OpenMode mode,
                             BenchPlan& plan) {
  const Database any = MNEME_TRY(Database::inspect(path));
  for (const LoadedProblem& loaded : plan.problems) {
    const Robot& robot = loaded.problem.robot;
    const std::pair key{name, robot.hash()};
    const RobotSignature signature = make_signature(robot);
    const bool applies = compare_robots(any.signature(), signature) <= RobotDifference::shapes;
    if (plan.memories.contains(key) || !applies) continue;
    Database database = MNEME_TRY(Database::open(path, signature, mode));
    plan.memories.emplace(key, std::make_shared<Database>(std::move(database)));
  }
  return {};
}

/// Creates an empty memory for the robot of the first problem that uses it.
Result<void> begin_memory(const std::string& name, const std::string& path, const BenchPlan& plan) {
  const Database any = MNEME_TRY(Database::inspect(path));
  if (any.size() > 0) return {};
  for (const LoadedProblem& loaded : plan.problems) {
    const bool is_used = std::ranges::any_of(plan.cases, [&](const BenchCase& c) {
      return c.memory == name && c.is_of_set(loaded.set);
    });
    if (!is_used) continue;
    return Database::open(path, make_signature(loaded.problem.robot), OpenMode::create)
        .map([](const Database&) {});
  }
  return {};
}

Result<void> check_sets(const SuiteSetting& setting, const std::vector<LoadedProblem>& problems) {
  for (const std::string& set : setting.sets) {
    if (std::ranges::find(problems, set, &LoadedProblem::set) != problems.end()) continue;
    return fail(ErrorCode::invalid, "setting {}: there is no set '{}' of problems", setting.name,
                set);
  }
  return {};
}

Result<void> add_setting(const SuiteSetting& setting, const SuiteHooks& hooks, BenchPlan& plan) {
  MNEME_TRY(check_sets(setting, plan.problems));
  BenchCase base;
  base.setting = setting.name;
  base.memory = setting.memory;
  base.sets = setting.sets;
  base.settings = setting.solve;
  base.description = describe_settings(setting.solve);
  if (!setting.memory.empty()) {
    base.description += (base.description.empty() ? "memory=" : " memory=") + setting.memory;
  }
  std::vector<std::string> planners;
  for (const std::string& planner : setting.planners) {
    if (find_rival(planner) != nullptr || find_planner(planner)) {
      planners.push_back(planner);
    } else {
      say(hooks, fmt::format("skipped: {}, because this build has no OMPL", planner));
    }
  }
  append_cases(base, planners, setting.samplers, plan.cases);
  return {};
}

Result<LearnSummary> learn_grid(const SuiteMemory& memory, const std::string& path, int jobs,
                                const SuiteHooks& hooks) {
  PrimitiveGrid grid = MNEME_TRY(load_grid(memory.primitives));
  grid.count = memory.count.value_or(grid.count);
  const std::string urdf = MNEME_TRY(robot_file(memory.robot));
  const auto [robot, notes] = MNEME_TRY(load_approximated_robot(urdf));
  for (const std::string& note : notes) say(hooks, note);
  Database database = MNEME_TRY(Database::open(path, make_signature(robot), OpenMode::create));
  std::vector<PrimitiveKey> keys = cover(grid, memory.seed, hooks.cancel);
  // A requested count is exact; cover() alone may return more to complete the grid.
  if (memory.count) keys.resize(std::min<std::size_t>(keys.size(), std::size_t(grid.count)));
  LearnJob job;
  job.jobs = jobs;
  job.seed = memory.seed;
  job.settings = memory.learn;
  watch(hooks, fmt::format("{} primitives", keys.size()), job);
  const LearnSummary summary = MNEME_TRY(learn_primitives(robot, keys, database, job));
  if (!summary.is_cancelled && database.size() != std::ssize(keys)) {
    return fail(ErrorCode::invalid,
                "'{}' has {} primitives, but memory {} has {}: delete the file, or use the "
                "settings that it was learned with",
                path, database.size(), memory.name, keys.size());
  }
  return summary;
}

Result<std::vector<Problem>> load_lessons(const SuiteMemory& memory, const SuiteHooks& hooks) {
  auto problems = MNEME_TRY(load_lesson_problems(memory.problems, {}, hooks.on_note));
  if (problems.empty()) return fail(ErrorCode::invalid, "{}: there are no problems", memory.name);
  return problems;
}

ProblemLesson lesson_of(const SuiteMemory& memory) {
  ProblemLesson lesson;
  lesson.paths = memory.paths;
  lesson.timeout_s = memory.path_timeout_s;
  lesson.seed = memory.seed;
  return lesson;
}

Result<LearnSummary> learn_problems(const SuiteMemory& memory, const std::string& path,
                                    const SuiteHooks& hooks) {
  const std::vector<Problem> problems = MNEME_TRY(load_lessons(memory, hooks));
  const Robot& robot = problems.front().robot;
  MemorySettings kind;
  kind.kind = memory.kind.value_or(std::string(default_kind_of_paths(robot).name));
  Database database = MNEME_TRY(Database::open(path, make_signature(robot), OpenMode::create));
  ProblemLesson lesson = lesson_of(memory);
  watch(hooks, fmt::format("{} problems", problems.size()), lesson);
  LearnSummary summary = MNEME_TRY(learn_from_problems(problems, kind, database, lesson));
  for (const std::string& problem : summary.unsolved) say(hooks, problem);
  return summary;
}

/// Learns missing rows of a memory and describes it in `row`. False if interrupted.
Result<bool> learn_memory(const SuiteMemory& memory, const std::string& path,
                          const std::vector<MemoryRow>& known, int jobs, const SuiteHooks& hooks,
                          MemoryRow& row) {
  LearnSummary learned;
  if (memory.file.empty()) {
    say(hooks, fmt::format("memory {}", memory.name));
    learned = MNEME_TRY(memory.primitives.empty() ? learn_problems(memory, path, hooks)
                                                  : learn_grid(memory, path, jobs, hooks));
    if (std::error_code error; !std::filesystem::exists(path, error)) {
      return fail(ErrorCode::invalid,
                  "memory {}: its problems taught nothing, perhaps because straight motions solve "
                  "them; use harder problems",
                  memory.name);
    }
  }
  const Database database = MNEME_TRY(Database::inspect(path));
  const DatabaseInfo info = database.info();
  row = {memory.name, info.samplers, info.components, info.bytes, learned.time_s};
  const auto before = std::ranges::find(known, memory.name, &MemoryRow::name);
  const bool is_same = before != known.end() && before->primitives == row.primitives &&
                       before->components == row.components;
  if (is_same) row.learning_time_s = before->learning_time_s;
  return !learned.is_cancelled;
}

/// Trains the planner's own experience from the paths that `memory` is learned from, planned again
/// with the same seeds. False if interrupted.
Result<bool> train(const SuiteMemory& memory, const PlannerEntry& planner, const std::string& file,
                   const SuiteHooks& hooks) {
  const std::vector<Problem> problems = MNEME_TRY(load_lessons(memory, hooks));
  ProblemLesson lesson = lesson_of(memory);
  lesson.cancel = hooks.cancel;
  std::vector<Path> paths;
  for (const Problem& problem : problems) {
    RepeatedPlan plan = MNEME_TRY(solve_repeatedly(problem, lesson));
    std::ranges::move(plan.paths, std::back_inserter(paths));
  }
  if (is_set(hooks.cancel)) return false;
  // Renaming ensures that an existing file is complete.
  const std::string partial = file + ".partial";
  MNEME_TRY(planner.train(problems.front().robot, paths, partial));
  std::error_code error;
  std::filesystem::rename(partial, file, error);
  if (error) return fail(ErrorCode::io, "'{}': {}", file, error.message());
  return true;
}

/// Trains planners with their own experience from the problems of their memory, into
/// `directory`/MEMORY.PLANNER unless it exists, and adds the file to the cases. False if
/// interrupted.
Result<bool> train_planners(const Suite& suite, const std::string& directory,
                            const SuiteHooks& hooks, std::vector<BenchCase>& cases) {
  for (BenchCase& bench_case : cases) {
    const std::string& planner = bench_case.settings.planner;
    const auto entry = find_planner(planner);
    if (!entry || !(*entry)->train) continue;
    const auto memory = std::ranges::find(suite.memories, bench_case.memory, &SuiteMemory::name);
    if (memory == suite.memories.end() || memory->problems.empty()) {
      return fail(ErrorCode::invalid, "setting {}: {} needs a memory that is learned from problems",
                  bench_case.setting, planner);
    }
    const std::string name = planner.substr(planner.find(':') + 1);
    const std::string file = fmt::format("{}/{}.{}", directory, memory->name, name);
    bench_case.settings.plan.experience_path = file;
    if (std::filesystem::exists(file)) continue;
    say(hooks,
        fmt::format("experience of {} from the problems of memory {}", planner, memory->name));
    const bool is_trained = MNEME_TRY(train(*memory, **entry, file, hooks));
    if (!is_trained) return false;
  }
  return true;
}

}  // namespace

std::string memory_file(const SuiteMemory& memory, const std::string& directory) {
  return memory.file.empty() ? fmt::format("{}/{}.db", directory, memory.name) : memory.file;
}

Result<ReadySuite> prepare_suite(const Suite& suite, const std::string& directory,
                                 const std::vector<MemoryRow>& known, int jobs,
                                 const SuiteHooks& hooks) {
  ReadySuite ready;
  ready.plan.problems = MNEME_TRY(load_bench_problems(suite.problems, {}, hooks.on_note));
  ready.plan.first_seed = suite.first_seed;
  ready.plan.seed_count = suite.seed_count;
  ready.plan.jobs = jobs;
  ready.plan.cancel = hooks.cancel;
  for (const SuiteSetting& setting : suite.settings) {
    MNEME_TRY(add_setting(setting, hooks, ready.plan));
  }
  for (const SuiteMemory& memory : suite.memories) {
    const std::string path = memory_file(memory, directory);
    MemoryRow& row = ready.memories.emplace_back();
    const bool is_learned = MNEME_TRY(learn_memory(memory, path, known, jobs, hooks, row));
    ready.is_interrupted = !is_learned;
    if (ready.is_interrupted) return ready;
    const bool grows = std::ranges::any_of(suite.settings, [&](const SuiteSetting& setting) {
      return setting.memory == memory.name && learns_while_planning(setting.solve);
    });
    if (grows) MNEME_TRY(begin_memory(memory.name, path, ready.plan));
    const OpenMode mode = grows ? OpenMode::read_write : OpenMode::read_only;
    MNEME_TRY(open_for_robots(memory.name, path, mode, ready.plan));
  }
  const bool is_trained = MNEME_TRY(train_planners(suite, directory, hooks, ready.plan.cases));
  ready.is_interrupted = !is_trained;
  return ready;
}

}  // namespace mneme::internal
