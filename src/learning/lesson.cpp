// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "learning/lesson.h"

#include <cstring>
#include <utility>

namespace mneme::internal {

std::uint64_t lesson_seed(std::uint64_t job_seed, const PrimitiveKey& key) {
  std::uint64_t seed = job_seed;
  for (const double value : key) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof(bits));
    seed = derive_seed(seed, bits);
  }
  return seed;
}

Result<std::set<std::uint64_t>> learned_seeds(const Database& database,
                                              const std::string& settings_text) {
  std::set<std::uint64_t> seeds;
  return database
      .for_each([&](const auto& row) {
        if (row->provenance.settings == settings_text) seeds.insert(row->provenance.seed);
      })
      .map([&] { return std::move(seeds); });
}

Result<LearnResult> learn(const Robot& robot, const Lesson& lesson, const LearnJob& job,
                          std::uint64_t seed) {
  if (lesson.problem == nullptr) {
    return learn_local_sampler(robot, *lesson.key, job.settings, seed, 0, job.cancel);
  }
  return learn_local_sampler(robot, *lesson.problem, job.settings, seed, 0, job.cancel);
}

Experience make_row(const Lesson& lesson, LocalSampler sampler, std::string settings_text,
                    std::uint64_t seed) {
  Experience row;
  row.kind = lesson.problem == nullptr ? decomposer_version("pairs").value() : lesson.problem->kind;
  row.key = *lesson.key;
  row.sampler = std::move(sampler);
  row.provenance.tool = "mneme " + std::string(version());
  row.provenance.settings = std::move(settings_text);
  row.provenance.seed = seed;
  return row;
}

void count(const Experience& row, LearnSummary& summary) {
  ++summary.learned;
  summary.components += row.sampler.component_count();
  if (row.sampler.component_count() == 0) ++summary.empty;
}

bool is_cancelled(const LearnJob& job) { return job.cancel != nullptr && job.cancel->load(); }

}  // namespace mneme::internal
