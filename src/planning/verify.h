// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>

#include "mneme/planning.h"
#include "planning/sweep.h"

namespace mneme::internal {

/// The check of motions of a final path. Const and parallel-safe.
class MotionVerifier {
 public:
  /// Refers to the checker.
  explicit MotionVerifier(const CollisionChecker& checker);

  /// True if the motion is free at kVerificationRefinement times the resolution and, of planar
  /// arms, between the states. `is_at_end`: it touches the start or the goal of its path, which may
  /// lie closer to contact than kVerificationMargin: then it needs no margin.
  [[nodiscard]] bool is_free(std::span<const float> from, std::span<const float> to, bool is_at_end,
                             CheckCounters& counters) const;

 private:
  const CollisionChecker& checker_;
  /// Links of planar arms are so thin that they pass through each other between two states,
  /// however close.
  std::optional<Sweep> sweep_;
};

}  // namespace mneme::internal
