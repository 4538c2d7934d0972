// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "suite_run.h"

#include "mneme/benchmark.h"

#include "bench_output.h"
#include "console.h"
#include "files.h"
#include "inputs.h"
#include "learning_run.h"
#include "lessons.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

namespace mneme::app {
namespace {

namespace fs = std::filesystem;

Result<LearnedMemory> learn_grid(const SuiteMemory& memory, const std::string& path, int jobs) {
  Result<PrimitiveGrid> grid = load_grid(memory.primitives);
  if (!grid) return tl::unexpected(grid.error());
  grid->count = memory.count.value_or(grid->count);
  const Result<Robot> robot = load_named_robot(memory.robot);
  if (!robot) return tl::unexpected(robot.error());
  Result<Database> database = Database::open(path, make_space(*robot), OpenMode::create);
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
    ProblemOptions overrides;
    overrides.robot_path = entry.robot;
    overrides.robot.srdf_path = entry.srdf;
    Result<std::vector<Problem>> loaded = load_problem_lesson({entry.where}, entry.part, overrides);
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
  MemorySettings kind;
  kind.kind = memory.kind.value_or(std::string(default_kind_of_paths(robot).name));
  Result<Database> database = Database::open(path, make_space(robot), OpenMode::create);
  if (!database) return tl::unexpected(database.error());
  const auto summary = learn_with_progress(*problems, kind, *database, lesson_of(memory));
  if (!summary) return tl::unexpected(summary.error());
  return LearnedMemory{summary->time_s, summary->is_cancelled};
}

/// The paths that `memory` is learned from, found again from the same seeds; false if interrupted.
Result<bool> train(const SuiteMemory& memory, const std::string& planner, const std::string& file) {
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
  const auto trained = find_planner(planner).and_then([&](const PlannerEntry* entry) {
    return entry->train(problems->front().robot, paths, partial);
  });
  if (!trained) return tl::unexpected(trained.error());
  std::error_code error;
  fs::rename(partial, file, error);
  if (error) return fail(ErrorCode::io, fmt::format("'{}': {}", file, error.message()));
  return true;
}

/// Leaves out settings that are not among `names`, and the memories that only they draw from.
Result<void> keep_settings(const std::vector<std::string>& names, Suite& suite) {
  for (const std::string& name : names) {
    if (std::ranges::find(suite.settings, name, &SuiteSetting::name) == suite.settings.end()) {
      return fail(ErrorCode::invalid,
                  fmt::format("the suite {} has no setting '{}'", suite.name, name));
    }
  }
  std::erase_if(suite.settings, [&](const SuiteSetting& setting) {
    return std::ranges::find(names, setting.name) == names.end();
  });
  std::erase_if(suite.memories, [&](const SuiteMemory& memory) {
    return std::ranges::find(suite.settings, memory.name, &SuiteSetting::memory) ==
           suite.settings.end();
  });
  return {};
}

Result<Suite> read_suite(const SuiteRun& run) {
  Result<Suite> suite = load_suite(run.suite);
  if (!suite) return suite;
  if (!run.settings.empty()) {
    if (auto kept = keep_settings(run.settings, *suite); !kept) return tl::unexpected(kept.error());
  }
  suite->seed_count = run.seed_count.value_or(suite->seed_count);
  for (SuiteSetting& setting : suite->settings) {
    double& timeout_s = setting.solve.plan.timeout_s;
    timeout_s = run.timeout_s.value_or(timeout_s);
    if (run.jobs > 1 && learns_while_planning(setting.solve)) {
      return fail(ErrorCode::invalid,
                  fmt::format("--jobs must be 1: setting {} learns while it plans", setting.name));
    }
  }
  return suite;
}

/// `memories` of this suite, and those of other suites that share the directory.
Result<void> write_shared(const std::string& path, std::vector<MemoryRow> known,
                          const std::vector<MemoryRow>& memories) {
  for (const MemoryRow& row : memories) {
    std::erase_if(known, [&](const MemoryRow& r) { return r.name == row.name; });
    known.push_back(row);
  }
  return write_file(path, to_csv(known));
}

/// Before anything is learned: a suite may name a memory where its results would be.
Result<void> check_files(const SuiteRun& run, const Suite& suite, const std::string& out,
                         const std::string& memories) {
  std::vector<ReadFile> inputs = {{"the suite", run.suite}};
  for (const SuiteProblems& entry : suite.problems) inputs.push_back({"a problem", entry.where});
  for (const SuiteMemory& memory : suite.memories) {
    inputs.push_back({"a memory", memory_file(memory, memories)});
  }
  const std::array outputs = {out + "/runs.csv", out + "/report.html", out + "/memories.csv"};
  return check_outputs(outputs, inputs);
}

SuiteHooks hooks_of(const SuiteRun& run) {
  const auto learn = [jobs = run.jobs](const SuiteMemory& memory, const std::string& path) {
    return memory.primitives.empty() ? learn_problems(memory, path)
                                     : learn_grid(memory, path, jobs);
  };
  return {learn, train, print_note};
}

Result<ReadySuite> prepare(const SuiteRun& run, const Suite& suite, const std::string& out) {
  const std::string directory = run.memories.empty() ? out + "/memories" : run.memories;
  if (auto checked = check_files(run, suite, out, directory); !checked) {
    return tl::unexpected(checked.error());
  }
  for (const std::string& path : {out, directory}) {
    if (auto made = make_directory(path); !made) return tl::unexpected(made.error());
  }
  const Result<std::vector<MemoryRow>> known = read_memories(directory + "/memories.csv");
  if (!known) return tl::unexpected(known.error());
  Result<ReadySuite> ready = prepare_suite(suite, directory, *known, hooks_of(run));
  if (!ready || ready->is_interrupted) return ready;
  ready->plan.jobs = run.jobs;
  ready->plan.cancel = interrupt_flag();
  const auto written =
      write_shared(directory + "/memories.csv", *known, ready->memories).and_then([&] {
        return write_file(out + "/memories.csv", to_csv(ready->memories));
      });
  if (!written) return tl::unexpected(written.error());
  return ready;
}

Result<void> write_results(const std::string& out, const std::string& name,
                           const std::vector<BenchmarkRow>& rows,
                           const std::vector<MemoryRow>& memories) {
  ReportOptions options;
  options.title = name;
  return write_report(out + "/report.html", make_benchmark_report(rows, memories, options))
      .and_then([&] { return write_ompl_logs(out + "/ompl", rows); });
}

}  // namespace

bool is_suite_file(const std::string& path) {
  if (!path.ends_with(".yaml") && !path.ends_with(".yml")) return false;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("problems:")) return true;
  }
  return false;
}

Result<ExitCode> run_suite(const SuiteRun& run) {
  const Result<Suite> suite = read_suite(run);
  if (!suite) return tl::unexpected(suite.error());
  const std::string out = run.out.empty() ? "out/bench/" + suite->name : run.out;
  Result<ReadySuite> ready = prepare(run, *suite, out);
  if (!ready) return tl::unexpected(ready.error());
  RowFile file;
  Result<bool> is_complete = false;
  if (!ready->is_interrupted) {
    is_complete = file.open(out + "/runs.csv", run.is_resumed).and_then([&] {
      return run_with_progress(ready->plan, file);
    });
    if (!is_complete) return tl::unexpected(is_complete.error());
  }
  const auto written = file.rows().empty()
                           ? Result<void>()
                           : write_results(out, suite->name, file.rows(), ready->memories);
  if (!written) return tl::unexpected(written.error());
  print_bench_results(file.rows(), run.is_json);
  if (!*is_complete) {
    print_note("interrupted; the same command with --resume goes on from here");
    return ExitCode::interrupted;
  }
  print_note(fmt::format("the report is {}/report.html", out));
  return judge_rows(file.rows());
}

}  // namespace mneme::app
