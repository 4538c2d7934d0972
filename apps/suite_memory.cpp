// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "suite_memory.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "bench_solve.h"
#include "console.h"
#include "inputs.h"
#include "interrupt.h"
#include "learning_run.h"
#include "lessons.h"

namespace mneme::app {
namespace {

namespace fs = std::filesystem;

struct LearnedMemory {
  double time_s = 0;
  bool is_cancelled = false;
};

Result<LearnedMemory> learn_grid(const SuiteMemory& memory, const std::string& path, int jobs) {
  Result<PrimitiveGrid> grid = load_grid(memory.primitives);
  if (!grid) return tl::unexpected(grid.error());
  grid->count = memory.count.value_or(grid->count);
  const Result<Robot> robot = load_named_robot(memory.robot);
  if (!robot) return tl::unexpected(robot.error());
  Result<Database> database = open_database(path, *robot, OpenMode::create);
  if (!database) return tl::unexpected(database.error());
  LearnJob job;
  job.jobs = jobs;
  job.seed = memory.seed;
  job.settings = memory.learn;
  std::vector<PrimitiveKey> keys = cover_grid(*grid, job.seed);
  // A count that was asked for is a size to measure, also where more would complete the cover.
  if (memory.count) keys.resize(std::min<std::size_t>(keys.size(), std::size_t(grid->count)));
  const auto summary = learn_with_progress(*robot, keys, *database, job);
  if (!summary) return tl::unexpected(summary.error());
  if (!summary->is_cancelled && database->size() != static_cast<std::int64_t>(keys.size())) {
    return fail(ErrorCode::invalid,
                fmt::format("'{}' holds {} primitives instead of the {} of memory {}: expected a "
                            "file that was learned with the same settings, or none",
                            path, database->size(), keys.size(), memory.name));
  }
  return LearnedMemory{summary->time_s, summary->is_cancelled};
}

Result<std::vector<Problem>> load_lessons(const SuiteMemory& memory) {
  std::vector<Problem> all;
  for (const SuiteProblems& entry : memory.problems) {
    Result<std::vector<Problem>> loaded = load_problem_lesson({entry.where}, entry.part, {});
    if (!loaded) return loaded;
    std::move(loaded->begin(), loaded->end(), std::back_inserter(all));
  }
  if (all.empty()) return fail(ErrorCode::invalid, memory.name + ": there are no problems");
  return all;
}

ProblemLesson lesson_of(const SuiteMemory& memory) {
  ProblemLesson lesson;
  lesson.paths = memory.paths;
  lesson.timeout_s = memory.path_timeout_s;
  lesson.seed = memory.seed;
  lesson.cancel = interrupt_flag();
  return lesson;
}

Result<LearnedMemory> learn_problems(const SuiteMemory& memory, const std::string& path) {
  const Result<std::vector<Problem>> problems = load_lessons(memory);
  if (!problems) return tl::unexpected(problems.error());
  const Robot& robot = problems->front().robot;
  DecomposeSettings decompose;
  decompose.decomposer = memory.decomposer;
  // Solved problems teach arms in space most as whole paths.
  if (decompose.decomposer.empty() && !robot.is_planar()) decompose.decomposer = "paths";
  Result<Database> database = open_database(path, robot, OpenMode::create);
  if (!database) return tl::unexpected(database.error());
  const auto summary = learn_with_progress(*problems, decompose, *database, lesson_of(memory));
  if (!summary) return tl::unexpected(summary.error());
  return LearnedMemory{summary->time_s, summary->is_cancelled};
}

/// The paths that `memory` is learned from, found again from the same seeds; false if interrupted.
Result<bool> train(const SuiteMemory& memory, const std::string& planner, const std::string& file) {
  print_note(fmt::format("experience of {} from the problems of memory {}", planner, memory.name));
  const Result<std::vector<Problem>> problems = load_lessons(memory);
  if (!problems) return tl::unexpected(problems.error());
  std::vector<Path> paths;
  for (const Problem& problem : *problems) {
    Result<RepeatedPlan> plan = solve_repeatedly(problem, lesson_of(memory));
    if (!plan) return tl::unexpected(plan.error());
    std::move(plan->paths.begin(), plan->paths.end(), std::back_inserter(paths));
  }
  if (interrupt_flag()->load()) return false;
  // A file that is there is whole, whenever this was killed.
  const std::string partial = file + ".partial";
  auto trained = train_experience(planner, problems->front().robot, paths, partial);
  if (!trained) return tl::unexpected(trained.error());
  std::error_code error;
  fs::rename(partial, file, error);
  if (error) return fail(ErrorCode::io, fmt::format("'{}': {}", file, error.message()));
  return true;
}

}  // namespace

std::string memory_file(const SuiteMemory& memory, const std::string& directory) {
  return memory.file.empty() ? fmt::format("{}/{}.db", directory, memory.name) : memory.file;
}

Result<bool> learn_memory(const SuiteMemory& memory, const std::string& path, int jobs,
                          const std::vector<MemoryRow>& known, MemoryRow& row) {
  const auto before = std::find_if(known.begin(), known.end(),
                                   [&](const MemoryRow& r) { return r.name == memory.name; });
  LearnedMemory learned;
  if (memory.file.empty()) {
    print_note(fmt::format("memory {}", memory.name));
    auto result =
        memory.primitives.empty() ? learn_problems(memory, path) : learn_grid(memory, path, jobs);
    if (!result) return tl::unexpected(result.error());
    learned = *result;
  }
  const Result<Database> database = inspect_database(path);
  if (!database) return tl::unexpected(database.error());
  const DatabaseInfo info = database->info();
  row = {memory.name, info.samplers, info.components, info.bytes, learned.time_s};
  const bool is_same = before != known.end() && before->primitives == row.primitives &&
                       before->components == row.components;
  if (is_same) row.learning_time_s = before->learning_time_s;
  return !learned.is_cancelled;
}

Result<bool> train_experiences(const Suite& suite, const std::string& directory,
                               std::vector<BenchCase>& cases) {
  for (BenchCase& bench_case : cases) {
    const std::string& planner = bench_case.settings.planner;
    if (!is_experience_planner(planner)) continue;
    const auto memory =
        std::find_if(suite.memories.begin(), suite.memories.end(),
                     [&](const SuiteMemory& m) { return m.name == bench_case.memory; });
    if (memory == suite.memories.end() || memory->problems.empty()) {
      return fail(ErrorCode::invalid,
                  fmt::format("setting {}: {} needs a memory that is learned from problems",
                              bench_case.setting, planner));
    }
    const std::string name = planner.substr(planner.find(':') + 1);
    bench_case.ompl_experience = fmt::format("{}/{}.{}", directory, memory->name, name);
    if (fs::exists(bench_case.ompl_experience)) continue;
    const Result<bool> trained = train(*memory, planner, bench_case.ompl_experience);
    if (!trained || !*trained) return trained;
  }
  return true;
}

}  // namespace mneme::app
