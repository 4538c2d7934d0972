// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// One primitive to learn, as a job does it on whichever thread, process or machine.
#pragma once

#include "mneme/learning.h"

#include <set>

namespace mneme::internal {

/// What to learn; without a problem, the pair of circles that the key describes.
struct Lesson {
  const PrimitiveKey* key = nullptr;
  const LocalProblem* problem = nullptr;
};

/// The seed of one lesson: depends on the primitive, not on its place in a list.
[[nodiscard]] std::uint64_t lesson_seed(std::uint64_t job_seed, const PrimitiveKey& key);

/// The seeds of what was learned with these settings before.
[[nodiscard]] Result<std::set<std::uint64_t>> learned_seeds(const Database& database,
                                                            const std::string& settings_text);

[[nodiscard]] Result<LearnResult> learn(const Robot& robot, const Lesson& lesson,
                                        const LearnJob& job, std::uint64_t seed);

/// The row that keeps what was learned.
[[nodiscard]] Experience make_row(const Lesson& lesson, LocalSampler sampler,
                                  std::string settings_text, std::uint64_t seed);

/// Counts a row that was learned.
void count(const Experience& row, LearnSummary& summary);

[[nodiscard]] bool is_cancelled(const LearnJob& job);

}  // namespace mneme::internal
