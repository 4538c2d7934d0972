// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string_view>

#include "base/stopwatch.h"
#include "mneme/pipeline.h"

namespace mneme::internal {

/// Algorithm 1: samples of `gl` with probability lambda. Without components, or for a sampler that
/// asks no memory, it is the sampler that `settings` names. The settings are complete.
[[nodiscard]] std::shared_ptr<const Sampler> make_sampler(const Robot& robot,
                                                          const SolveSettings& settings,
                                                          const GlSampler& gl);

/// True for samplers that draw from a database: "gl", and the baselines that do without local
/// retrieval.
[[nodiscard]] bool is_memory_sampler(std::string_view sampler);

/// Algorithm 2, or the baseline that `settings.sampler` names, for one query, at once or when the
/// planner asks for it; once only, whichever of the sampler's streams asks first, and from
/// whichever thread.
class Recall {
 public:
  /// Refers to all of them; the settings are complete.
  Recall(const Problem& problem, Database& database, const CollisionChecker& checker,
         const SolveSettings& settings)
      : problem_(problem), database_(database), checker_(checker), settings_(settings) {}

  /// The sampler for a planner; refers to this.
  [[nodiscard]] std::shared_ptr<const Sampler> make_sampler();

  /// Why memory could not be asked, until now.
  [[nodiscard]] const std::optional<Error>& failure() const { return failure_; }
  [[nodiscard]] GlSampler take() { return std::move(gl_); }

 private:
  [[nodiscard]] std::shared_ptr<const Sampler> recalled();
  [[nodiscard]] std::shared_ptr<const Sampler> ask();
  [[nodiscard]] Result<GlSampler> recall() const;
  [[nodiscard]] Result<std::shared_ptr<const Sampler>> decode();

  Stopwatch stopwatch_;
  const Problem& problem_;
  Database& database_;
  const CollisionChecker& checker_;
  const SolveSettings& settings_;
  std::mutex mutex_;
  std::shared_ptr<const Sampler> sampler_;
  GlSampler gl_;
  std::optional<Error> failure_;
};

}  // namespace mneme::internal
