// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "learning_run.h"

#include "console.h"

#include <fmt/format.h>

#include <memory>

namespace mneme::app {
namespace {

constexpr int kCoverageProbes = 2000;
constexpr std::uint64_t kCoverageSeed = 1;

}  // namespace

void watch_learning(LearnRun& run, const std::string& what) {
  run.cancel = interrupt_flag();
  const auto progress = std::make_shared<Progress>("learning");
  run.on_progress = [progress](const LearnProgress& state) {
    progress->update(state.done, state.total, fmt::format("{} components", state.components));
  };
  print_note(fmt::format("learning {} with {}, seed {}", what,
                         counted(run.jobs, "thread", "threads"), run.seed));
}

std::vector<PrimitiveKey> cover_grid(const PrimitiveGrid& grid, std::uint64_t seed) {
  const std::atomic<bool>* cancel = interrupt_flag();
  print_note("choosing primitives that cover the range");
  return cover(grid, seed, cancel);
}

Result<LearnSummary> learn_with_progress(const Robot& robot, std::span<const PrimitiveKey> keys,
                                         Database& database, LearnJob job) {
  watch_learning(job, counted(keys.size(), "primitive", "primitives"));
  return learn_primitives(robot, keys, database, job);
}

Result<LearnSummary> learn_with_progress(std::span<const Problem> problems,
                                         const MemorySettings& memory, Database& database,
                                         ProblemLesson lesson) {
  watch_learning(lesson, counted(problems.size(), "problem", "problems"));
  LearnSummary summary = MNEME_TRY(learn_from_problems(problems, memory, database, lesson));
  lesson.on_progress = nullptr;  // removes the bar
  for (const std::string& problem : summary.unsolved) print_note(problem);
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
