// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "learning_run.h"

#include "console.h"

#include <fmt/format.h>

namespace mneme::app {
namespace {

constexpr int kCoverageProbes = 2000;
constexpr std::uint64_t kCoverageSeed = 1;

/// Lets a run heed an interrupt and show how far it is.
void watch(LearnRun& run, Progress& progress, const std::string& what) {
  run.cancel = interrupt_flag();
  run.on_progress = [&progress](const LearnProgress& state) {
    progress.update(state.done, state.total, fmt::format("{} components", state.components));
  };
  print_note(fmt::format("learning {} with {}, seed {}", what,
                         counted(static_cast<std::size_t>(run.jobs), "thread", "threads"),
                         run.seed));
}

}  // namespace

std::vector<PrimitiveKey> cover_grid(const PrimitiveGrid& grid, std::uint64_t seed) {
  const std::atomic<bool>* cancel = interrupt_flag();
  print_note("choosing primitives that cover the range");
  return cover(grid, seed, cancel);
}

Result<LearnSummary> learn_with_progress(const Robot& robot, std::span<const PrimitiveKey> keys,
                                         Database& database, LearnJob job) {
  Progress progress("learning");
  watch(job, progress, counted(keys.size(), "primitive", "primitives"));
  return learn_primitives(robot, keys, database, job);
}

Result<LearnSummary> learn_with_progress(std::span<const Problem> problems,
                                         const MemorySettings& memory, Database& database,
                                         ProblemLesson lesson) {
  Result<LearnSummary> summary;
  {
    Progress progress("learning");
    watch(lesson, progress, counted(problems.size(), "problem", "problems"));
    summary = learn_from_problems(problems, memory, database, lesson);
  }
  if (summary) {
    for (const std::string& problem : summary->unsolved) print_note(problem);
  }
  return summary;
}

Result<Coverage> measure_coverage(const Database& database, const PrimitiveGrid& grid) {
  std::vector<PrimitiveKey> keys;
  const std::string_view kind = memory_kinds().front()->version;
  const auto add = [&](const auto& row) {
    if (row->kind == kind) keys.push_back(row->key);
  };
  return database.for_each(add).map(
      [&] { return mneme::measure_coverage(grid, keys, kCoverageProbes, kCoverageSeed); });
}

}  // namespace mneme::app
