// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "suite_run.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>

#include "bench_report.h"
#include "bench_results.h"
#include "bench_solve.h"
#include "bench_suite.h"
#include "console.h"
#include "output_check.h"
#include "output_file.h"
#include "suite_memory.h"

namespace mneme::app {
namespace {

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
  Result<Suite> suite = load_suite(run.suite, bench_names());
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
  const std::array outputs = {out + "/runs.csv", out + "/runs.sqlite", out + "/report.html",
                              out + "/planner_arena.db", out + "/memories.csv"};
  return check_outputs(outputs, inputs);
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
  Result<ReadySuite> ready = make_ready(suite, directory, *known, run.jobs);
  if (!ready || ready->is_interrupted) return ready;
  ready->plan.jobs = run.jobs;
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
      .and_then([&] { return write_ompl_logs(out + "/ompl", rows); })
      .and_then([&] { return write_planner_arena(out + "/planner_arena.db", rows); });
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
    is_complete = file.open(out + "/runs.csv", out + "/runs.sqlite", run.is_resumed).and_then([&] {
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
