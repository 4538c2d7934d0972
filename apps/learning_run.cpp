// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "learning_run.h"

#include "console.h"

#include <fmt/format.h>

namespace mneme::app {
namespace {

constexpr int kCoverageProbes = 2000;
constexpr std::uint64_t kCoverageSeed = 1;

}  // namespace

std::vector<PrimitiveKey> cover_grid(const PrimitiveGrid& grid, std::uint64_t seed) {
  const std::atomic<bool>* cancel = interrupt_flag();
  print_note("choosing primitives that cover the range");
  return cover(grid, seed, cancel);
}

namespace {

template <class Primitive>
Result<LearnSummary> learn(const Robot& robot, std::span<const Primitive> primitives,
                           Database& database, LearnJob job) {
  job.cancel = interrupt_flag();
  print_note(fmt::format("learning {} primitives with {} threads, seed {}", primitives.size(),
                         job.jobs, job.seed));
  Progress progress("learning");
  job.on_progress = [&](const LearnProgress& state) {
    progress.update(state.done, state.total, fmt::format("{} components", state.components));
  };
  return learn_primitives(robot, primitives, database, job);
}

}  // namespace

Result<LearnSummary> learn_with_progress(const Robot& robot, std::span<const PrimitiveKey> keys,
                                         Database& database, LearnJob job) {
  return learn(robot, keys, database, std::move(job));
}

Result<LearnSummary> learn_with_progress(const Robot& robot,
                                         std::span<const LocalProblem> primitives,
                                         Database& database, LearnJob job) {
  return learn(robot, primitives, database, std::move(job));
}

Result<Coverage> measure_coverage(const Database& database, const PrimitiveGrid& grid) {
  std::vector<PrimitiveKey> keys;
  return database.for_each([&](const auto& row) { keys.push_back(row->key); }).map([&] {
    return mneme::measure_coverage(grid, keys, kCoverageProbes, kCoverageSeed);
  });
}

}  // namespace mneme::app
