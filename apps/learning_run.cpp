// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "learning_run.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "console.h"
#include "interrupt.h"

namespace mneme::app {
namespace {

constexpr int kCoverageSamples = 2000;
constexpr std::uint64_t kCoverageSeed = 20190520;

}  // namespace

std::vector<PrimitiveKey> keys_before(const Database& database, std::uint64_t seed) {
  std::vector<PrimitiveKey> keys;
  for (std::int64_t i = 0; i < database.size(); ++i) {
    if (database.get(i).provenance.seed == seed) return keys;
    keys.push_back(database.get(i).key);
  }
  return keys;
}

Result<LearnSummary> learn_with_progress(const Robot& robot, std::span<const PrimitiveKey> keys,
                                         Database& database, LearnJob job) {
  print_note(fmt::format("learning {} primitives with {} threads, seed {}", keys.size(), job.jobs,
                         job.seed));
  Progress progress("learning");
  job.cancel = interrupt_flag();
  job.on_progress = [&](const LearnProgress& state) {
    progress.update(state.done, state.total, fmt::format("{} components", state.components));
  };
  return learn_primitives(robot, keys, database, job);
}

Coverage measure_coverage(const Database& database, const PrimitiveGrid& grid) {
  constexpr double kNoMatch = std::numeric_limits<double>::infinity();
  Rng rng(kCoverageSeed);
  std::vector<double> errors;
  for (int i = 0; i < kCoverageSamples; ++i) {
    const LocalPrimitive primitive = make_primitive(sample_primitive(grid, rng));
    const std::vector<Match> matches = database.find(primitive, kNoMatch, 1);
    errors.push_back(matches.empty() ? kNoMatch : matches.front().similarity_error);
  }
  std::sort(errors.begin(), errors.end());
  const auto matched = std::lower_bound(errors.begin(), errors.end(), grid.max_similarity_error);
  return {kCoverageSamples,
          static_cast<double>(matched - errors.begin()) / static_cast<double>(errors.size()),
          errors[errors.size() / 2], errors[errors.size() * 95 / 100], errors.back()};
}

}  // namespace mneme::app
