// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Ways out of where a tree is stuck.
#pragma once

#include "mneme/collision.h"

#include "planning/planner_run.h"
#include "planning/tree.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace mneme::internal {

/// Walks of small steps that pull a limb of the robot back along itself, as one leaves a shelf or a
/// row of obstacles, while all of the robot keeps off obstacles. Straight motions hardly ever leave
/// a narrow passage; these bend along it. All lengths are shares of the limb's, so that one rule
/// serves all robots. Not thread-safe.
class EscapeWalk {
 public:
  explicit EscapeWalk(PlannerRun& run);

  /// True, as often as the settings say, if it is time for a walk.
  [[nodiscard]] bool is_due();
  /// Walks from the newest node of `tree` until no step is free; each step becomes a node. The last
  /// one, or -1 if there is none.
  int extend(Tree& tree);

 private:
  /// Samples what stays the same along a walk.
  void begin();
  /// One step from `node`; the new node, or -1.
  int advance(Tree& tree, int node);
  void sample_jitter();

  PlannerRun& run_;
  Rng rng_;
  std::vector<LimbInfo> limbs_;
  double probability_;
  std::uint64_t first_iteration_;
  WalkStep step_;
  std::vector<float> drift_sizes_;  ///< per joint: slides drift half as many metres
  std::vector<float> drift_, jitter_, candidates_;
  std::vector<std::uint8_t> is_valid_;
};

}  // namespace mneme::internal
