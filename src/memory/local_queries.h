// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Learning a local sampler from queries, whatever the robot: where they start and end is the
/// business of a QuerySource.
#pragma once

#include "mneme/memory.h"

#include <atomic>
#include <optional>
#include <span>

namespace mneme::internal {

/// Where the local queries of one primitive start and end. Const is parallel-safe.
class QuerySource {
 public:
  virtual ~QuerySource() = default;
  /// Kinds of starts: 0 to depth_count() - 1, from shallow to deep.
  [[nodiscard]] virtual int depth_count() const = 0;
  /// A valid configuration in the passage; nothing if none of that depth was found. `earlier` are
  /// the starts drawn before, most of them shallower.
  [[nodiscard]] virtual std::optional<Configuration> draw_start(
      int depth, std::span<const Configuration> earlier, Rng& rng) const = 0;
  /// True if the robot is out of the passage.
  [[nodiscard]] virtual bool is_clear(std::span<const double> q) const = 0;
};

/// Solves queries from shallow to deep, each with Algorithm 1 over what the shallower ones have
/// taught, and gathers their waypoints; see learn_local_sampler() for the rest. Means are in the
/// frame of the checker's scene.
[[nodiscard]] LearnResult learn_from_queries(const CollisionChecker& checker,
                                             const QuerySource& source,
                                             const LearnSettings& settings, std::uint64_t seed,
                                             double deadline_s, const std::atomic<bool>* cancel);

}  // namespace mneme::internal
