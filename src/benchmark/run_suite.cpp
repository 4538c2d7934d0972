// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/benchmark.h"
#include "mneme/report.h"

#include "base/fail.h"
#include "base/files.h"
#include "benchmark/suite_memories.h"

#include <algorithm>
#include <array>
#include <sstream>

namespace mneme {
namespace {

/// Keeps only the settings `names` and their memories.
Result<void> keep_settings(const std::vector<std::string>& names, Suite& suite) {
  for (const std::string& name : names) {
    if (std::ranges::find(suite.settings, name, &SuiteSetting::name) == suite.settings.end()) {
      return fail(ErrorCode::invalid, "the suite {} has no setting '{}'", suite.name, name);
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
  Suite suite = MNEME_TRY(load_suite(run.suite));
  if (!run.settings.empty()) MNEME_TRY(keep_settings(run.settings, suite));
  suite.seed_count = run.seed_count.value_or(suite.seed_count);
  for (SuiteSetting& setting : suite.settings) {
    double& timeout_s = setting.solve.plan.timeout_s;
    timeout_s = run.timeout_s.value_or(timeout_s);
    if (run.jobs > 1 && learns_while_planning(setting.solve)) {
      return fail(ErrorCode::invalid, "--jobs must be 1: setting {} learns while it plans",
                  setting.name);
    }
  }
  return suite;
}

/// Refuses outputs that are also inputs, before anything is learned.
Result<void> check_suite_files(const SuiteRun& run, const Suite& suite, const std::string& out,
                               const std::string& memories) {
  std::vector<ReadFile> inputs = {{"the suite", run.suite}};
  for (const SuiteProblems& entry : suite.problems) inputs.push_back({"a problem", entry.where});
  for (const SuiteMemory& memory : suite.memories) {
    inputs.push_back({"a memory", internal::memory_file(memory, memories)});
  }
  return check_outputs(std::array{out + "/runs.csv", out + "/report.html", out + "/memories.csv"},
                       inputs);
}

Result<internal::ReadySuite> prepare(const SuiteRun& run, const Suite& suite,
                                     const std::string& out, const SuiteHooks& hooks) {
  const std::string directory = run.memories.empty() ? out + "/memories" : run.memories;
  MNEME_TRY(check_suite_files(run, suite, out, directory));
  for (const std::string& path : {out, directory}) MNEME_TRY(make_directory(path));
  const std::string shared = directory + "/memories.csv";
  std::vector<MemoryRow> known = MNEME_TRY(read_memories(shared));
  auto ready = MNEME_TRY(internal::prepare_suite(suite, directory, known, run.jobs, hooks));
  if (ready.is_interrupted) return ready;
  // Keep rows of other suites in the same directory.
  for (const MemoryRow& row : ready.memories) {
    std::erase_if(known, [&](const MemoryRow& r) { return r.name == row.name; });
    known.push_back(row);
  }
  MNEME_TRY(write_file(shared, to_csv(known)));
  MNEME_TRY(write_file(out + "/memories.csv", to_csv(ready.memories)));
  return ready;
}

}  // namespace

bool is_suite_file(const std::string& path) {
  if (!path.ends_with(".yaml") && !path.ends_with(".yml")) return false;
  std::istringstream text(internal::read_text_file(path).value_or(""));
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with("problems:")) return true;
  }
  return false;
}

Result<SuiteResult> run_suite(const SuiteRun& run, const SuiteHooks& hooks) {
  const Suite suite = MNEME_TRY(read_suite(run));
  const std::string out = run.out.empty() ? "out/bench/" + suite.name : run.out;
  internal::ReadySuite ready = MNEME_TRY(prepare(run, suite, out, hooks));
  SuiteResult result;
  result.report = out + "/report.html";
  if (ready.is_interrupted) return result;
  ready.plan.is_cold = run.is_cold;
  RowFile file;
  MNEME_TRY(file.open(out + "/runs.csv", run.is_resumed));
  result.is_complete = MNEME_TRY(run_bench(ready.plan, file, hooks.on_rows));
  result.rows = file.rows();
  if (result.rows.empty()) return result;
  ReportOptions options;
  options.title = suite.name;
  MNEME_TRY(
      write_report(result.report, make_benchmark_report(result.rows, ready.memories, options)));
  MNEME_TRY(write_ompl_logs(out + "/ompl", result.rows));
  return result;
}

}  // namespace mneme
