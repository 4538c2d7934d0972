// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "bench_suite.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include <fmt/format.h>

#include "bench_problems.h"
#include "bench_solve.h"
#include "console.h"
#include "inputs.h"
#include "learn_from_problems.h"
#include "learning_run.h"
#include "output_file.h"
#include "problem_part.h"

namespace mneme::app {
namespace {

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

Result<std::vector<Problem>> load_lessons(const std::vector<SuiteProblems>& problems) {
  std::vector<Problem> all;
  for (const SuiteProblems& entry : problems) {
    ProblemLesson lesson;
    lesson.problems = {entry.where};
    lesson.part = entry.part;
    Result<std::vector<Problem>> loaded = load_lesson(lesson, {});
    if (!loaded) return loaded;
    std::move(loaded->begin(), loaded->end(), std::back_inserter(all));
  }
  return all;
}

Result<LearnedMemory> learn_problems(const SuiteMemory& memory, const std::string& path) {
  const Result<std::vector<Problem>> problems = load_lessons(memory.problems);
  if (!problems) return tl::unexpected(problems.error());
  if (problems->empty()) return fail(ErrorCode::invalid, memory.name + ": there are no problems");
  ProblemLesson lesson;
  lesson.paths = memory.paths;
  lesson.timeout_s = memory.path_timeout_s;
  lesson.seed = memory.seed;
  const Robot& robot = problems->front().robot;
  DecomposeSettings decompose;
  decompose.decomposer = memory.decomposer;
  // Solved problems teach arms in space most as whole paths.
  if (decompose.decomposer.empty() && !robot.is_planar()) decompose.decomposer = "paths";
  Result<Database> database = open_database(path, robot, OpenMode::create, decompose.decomposer);
  if (!database) return tl::unexpected(database.error());
  const auto summary = learn_from_problems(*problems, lesson, decompose, *database);
  if (!summary) return tl::unexpected(summary.error());
  return LearnedMemory{summary->time_s, summary->is_cancelled};
}

/// Learns what is not there yet; `row` is told what it took and what there is now.
Result<LearnedMemory> learn(const SuiteMemory& memory, const std::string& path, int jobs,
                            const std::vector<MemoryRow>& known, MemoryRow& row) {
  const auto before = std::find_if(known.begin(), known.end(),
                                   [&](const MemoryRow& r) { return r.name == memory.name; });
  LearnedMemory learned;
  if (memory.file.empty()) {
    print_note(fmt::format("memory {}", memory.name));
    auto result =
        memory.primitives.empty() ? learn_problems(memory, path) : learn_grid(memory, path, jobs);
    if (!result) return result;
    learned = *result;
  }
  const Result<Database> database = inspect_database(path);
  if (!database) return tl::unexpected(database.error());
  const DatabaseInfo info = database->info();
  row = {memory.name, info.samplers, info.components, info.bytes, learned.time_s};
  const bool is_same = before != known.end() && before->primitives == row.primitives &&
                       before->components == row.components;
  if (is_same) row.learning_time_s = before->learning_time_s;
  return learned;
}

Result<void> open_for_robots(const std::string& name, const std::string& path, OpenMode mode,
                             BenchPlan& plan) {
  const Result<Database> any = inspect_database(path);
  if (!any) return tl::unexpected(any.error());
  for (const LoadedProblem& loaded : plan.problems) {
    const Robot& robot = loaded.problem.robot;
    const std::pair key{name, robot.hash()};
    if (plan.memories.contains(key) || any->space().robot_hash != robot.hash()) continue;
    Result<Database> database = open_database(path, robot, mode);
    if (!database) return tl::unexpected(database.error());
    plan.memories.emplace(key, std::move(*database));
  }
  return {};
}

Result<void> check_sets(const SuiteSetting& setting, const std::vector<LoadedProblem>& problems) {
  for (const std::string& set : setting.sets) {
    const bool is_known = std::any_of(problems.begin(), problems.end(),
                                      [&](const LoadedProblem& p) { return p.set == set; });
    if (!is_known) {
      return fail(ErrorCode::invalid,
                  fmt::format("setting {}: there is no set '{}' of problems", setting.name, set));
    }
  }
  return {};
}

Result<void> add_setting(const SuiteSetting& setting, ReadySuite& ready) {
  if (auto checked = check_sets(setting, ready.plan.problems); !checked) return checked;
  std::vector<std::string> planners;
  for (const std::string& planner : setting.planners) {
    if (!is_missing_planner(planner))
      planners.push_back(planner);
    else
      print_note(fmt::format("left out: {}, because this build has no OMPL", planner));
  }
  BenchCase base;
  base.setting = setting.name;
  base.memory = setting.memory;
  base.sets = setting.sets;
  base.settings = setting.solve;
  base.is_ompl_as_in_paper = setting.is_ompl_as_in_paper;
  base.description = describe_settings(setting.solve);
  const auto add = [&](const std::string& text) {
    base.description += (base.description.empty() ? "" : " ") + text;
  };
  if (setting.is_ompl_as_in_paper) add("ompl-defaults=true");
  if (!setting.memory.empty()) add("memory=" + setting.memory);
  append_cases(base, planners, setting.samplers, ready.plan.cases);
  return {};
}

bool learns_online(const Suite& suite, const std::string& memory) {
  return std::any_of(suite.settings.begin(), suite.settings.end(), [&](const SuiteSetting& s) {
    return s.memory == memory && learns_while_planning(s.solve);
  });
}

}  // namespace

Result<std::vector<LoadedProblem>> load_bench_problems(const std::vector<SuiteProblems>& found,
                                                       const ProblemOptions& overrides) {
  std::vector<LoadedProblem> problems;
  std::set<std::string> warnings;
  for (const SuiteProblems& entry : found) {
    auto all = find_bench_problems({entry.where}).and_then([&](auto list) {
      return take_part(std::move(list), entry.part);
    });
    if (!all) return tl::unexpected(all.error());
    for (const BenchProblem& bench : *all) {
      Result<Problem> problem = load_problem(bench.where, overrides);
      if (!problem) return tl::unexpected(problem.error());
      for (const std::string& warning : problem->warnings) {
        if (warnings.insert(warning).second) print_note("warning: " + warning);
      }
      problems.push_back({entry.set.empty() ? bench.set : entry.set, std::move(*problem)});
    }
  }
  return problems;
}

Result<ReadySuite> make_ready(const Suite& suite, const std::string& directory,
                              const std::vector<MemoryRow>& known, int jobs) {
  ReadySuite ready;
  auto problems = load_bench_problems(suite.problems, {});
  if (!problems) return tl::unexpected(problems.error());
  ready.plan.problems = std::move(*problems);
  ready.plan.first_seed = suite.first_seed;
  ready.plan.seed_count = suite.seed_count;
  for (const SuiteSetting& setting : suite.settings) {
    if (auto added = add_setting(setting, ready); !added) return tl::unexpected(added.error());
  }
  if (auto made = make_directory(directory); !made) return tl::unexpected(made.error());
  for (const SuiteMemory& memory : suite.memories) {
    const std::string path =
        memory.file.empty() ? fmt::format("{}/{}.db", directory, memory.name) : memory.file;
    const auto learned = learn(memory, path, jobs, known, ready.memories.emplace_back());
    if (!learned) return tl::unexpected(learned.error());
    if ((ready.is_interrupted = learned->is_cancelled)) return ready;
    const OpenMode mode =
        learns_online(suite, memory.name) ? OpenMode::read_write : OpenMode::read_only;
    const auto opened = open_for_robots(memory.name, path, mode, ready.plan);
    if (!opened) return tl::unexpected(opened.error());
  }
  return ready;
}

}  // namespace mneme::app
