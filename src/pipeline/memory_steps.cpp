// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/memory_steps.h"

#include "base/threads.h"
#include "memory/sampled_components.h"

#include <algorithm>
#include <utility>

namespace mneme::internal {
namespace {

/// Seconds of the time limit that learning leaves for insertion, which waits for the disk.
constexpr double kInsertionTime = 0.01;

/// True with a complete sampler, or with max_matches incomplete ones.
bool is_known(const PrimitiveRetrieval& primitive, const KindSettings& kind) {
  const auto is_complete = [](const Match& match) {
    return match.experience->sampler().is_complete;
  };
  return std::ssize(primitive.matches) >= kind.matches.max_matches ||
         std::ranges::any_of(primitive.matches, is_complete);
}

/// Differs from the seeds of the lessons that it continues.
std::uint64_t lesson_seed(std::uint64_t seed, const PrimitiveRetrieval& primitive) {
  return primitive.matches.empty() ? seed : derive_seed(seed, primitive.matches.size());
}

}  // namespace

Provenance provenance_of(std::string settings, std::uint64_t seed) {
  return {"mneme " + std::string(version()), std::move(settings), seed, {}};
}

std::vector<Experience> new_row(std::string_view kind, PrimitiveKey key,
                                decltype(Experience::content) content, Provenance provenance) {
  std::vector<Experience> rows(1);
  rows.front() = {0, std::string(kind), std::move(key), std::move(content), std::move(provenance)};
  return rows;
}

Result<std::vector<PrimitiveRetrieval>> decompose(const MemoryQuery& query,
                                                  const KindSettings& kind) {
  std::vector<PrimitiveRetrieval> retrievals;
  for (LocalPrimitive& primitive : MNEME_TRY(kind.kind->decompose(query, kind.max_gap))) {
    retrievals.emplace_back().primitive = std::move(primitive);
  }
  return retrievals;
}

Result<void> retrieve(const Database& database, const KindSettings& kind,
                      PrimitiveRetrieval& primitive) {
  primitive.matches =
      MNEME_TRY(find_matches(database, *kind.kind, primitive.primitive, kind.matches));
  return {};
}

Result<void> learn(const Query& query, const MemoryQuery& memory_query, const KindSettings& kind,
                   PrimitiveRetrieval& primitive, double& learning_time_s) {
  const SolveSettings& settings = query.settings;
  const double budget_s =
      std::min(settings.learn_budget_s - learning_time_s, query.remaining_s() - kInsertionTime);
  const bool can_learn = kind.kind->can_learn_primitives();
  if (budget_s <= 0 || !can_learn || is_known(primitive, kind)) return {};
  const Stopwatch stopwatch;
  LearnSettings learning = settings.learn;
  if (!learning.resolution) learning.resolution = settings.resolution;
  const std::uint64_t seed = lesson_seed(settings.plan.seed, primitive);
  LearnResult learned = MNEME_TRY(kind.kind->learn(memory_query.robot, primitive.primitive.key,
                                                   learning, seed, budget_s, settings.plan.cancel));
  // An empty result of a short budget is not kept: a longer one may find components.
  if (learned.sampler.component_count() > 0) {
    primitive.is_learned = true;
    learned.sampler.is_complete = learned.time_s < budget_s && !is_set(settings.plan.cancel);
    MNEME_TRY(query.database->insert(new_row(primitive.primitive.kind, primitive.primitive.key,
                                             std::move(learned.sampler),
                                             provenance_of(describe(learning) + " budget", seed))));
    MNEME_TRY(retrieve(*query.database, kind, primitive));
  }
  learning_time_s += stopwatch.elapsed_s();
  return {};
}

Recalled synthesize(const MemoryQuery& query, const KindSettings& kind,
                    std::span<const PrimitiveRetrieval> primitives, SampleSource first_source) {
  if (kind.retarget && kind.kind->retarget != nullptr) {
    auto source = kind.kind->retarget(query, primitives, first_source);
    if (source != nullptr) return source;
  }
  GaussianMixture mixture = kind.kind->synthesize(query, primitives);
  for (SampleSource& source : mixture.sources) source += first_source;
  return mixture;
}

void append(GaussianMixture& all, const GaussianMixture& more) {
  const int joints = more.joint_count;
  const int factors = all.factor_count();
  const auto before = static_cast<std::size_t>(all.component_count());
  const auto count = static_cast<std::size_t>(more.component_count());
  all.joint_count = joints;
  all.means.insert(all.means.end(), more.means.begin(), more.means.end());
  all.factors.insert(all.factors.end(), more.factors.begin(), more.factors.end());
  all.factor_rows.resize(before, -1);
  all.sources.resize(before, 0);
  for (std::size_t i = 0; i < count; ++i) {
    const int row = more.factor_rows.empty() ? -1 : more.factor_rows[i];
    all.factor_rows.push_back(row < 0 ? -1 : factors + row);
    all.sources.push_back(more.sources.empty() ? 0 : more.sources[i]);
  }
}

GaussianMixture keep_valid_components(const CollisionChecker& checker,
                                      const GaussianMixture& mixture) {
  const auto count = static_cast<std::size_t>(mixture.component_count());
  const auto joints = static_cast<std::size_t>(mixture.joint_count);
  std::vector<std::uint8_t> is_valid(count);
  checker.check_states(mixture.means, is_valid);
  if (std::find(is_valid.begin(), is_valid.end(), 1) == is_valid.end()) return mixture;
  GaussianMixture kept;
  kept.joint_count = mixture.joint_count;
  kept.factors = mixture.factors;
  for (std::size_t i = 0; i < count; ++i) {
    if (is_valid[i] == 0) continue;
    const auto mean = mixture.means.begin() + static_cast<std::ptrdiff_t>(i * joints);
    kept.means.insert(kept.means.end(), mean, mean + static_cast<std::ptrdiff_t>(joints));
    if (!mixture.factor_rows.empty()) kept.factor_rows.push_back(mixture.factor_rows[i]);
    if (!mixture.sources.empty()) kept.sources.push_back(mixture.sources[i]);
  }
  return kept;
}

}  // namespace mneme::internal
