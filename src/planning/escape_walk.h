// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Escape walks out of narrow places.
#pragma once

#include "mneme/collision.h"

#include "planning/planner_run.h"
#include "planning/tree.h"

#include <cstdint>
#include <vector>

namespace mneme::internal {

/// Small steps that pull a limb of the robot back along itself, as out of a shelf, and push all
/// links away from obstacles. Straight motions hardly ever leave a narrow passage; walks bend along
/// it. Lengths are relative to the limb's length, so that one rule serves all robots. Not
/// thread-safe.
class EscapeWalk {
 public:
  explicit EscapeWalk(PlannerRun& run);

  /// True while walks have taken less than their share of the work, once enough iterations have
  /// passed. Among many obstacles a walk costs as much as thousands of iterations.
  [[nodiscard]] bool is_due();
  /// Walks from the newest node of `tree` until no step is free; each step becomes a node. Returns
  /// the last new node, or -1.
  int extend(Tree& tree);

 private:
  /// Makes what walks need, once: most searches end before the first walk.
  void prepare();
  /// Samples the constants of a walk.
  void begin();
  /// One step from `node`; the new node, or -1.
  int advance(Tree& tree, int node);
  void sample_jitter();

  PlannerRun& run_;
  Rng rng_;
  std::vector<LimbInfo> limbs_;
  double share_;            ///< largest share of walks in PlannerRun::work()
  std::uint64_t work_ = 0;  ///< of walks so far
  std::uint64_t first_iteration_;
  WalkStep step_;
  std::vector<float> drift_sizes_;  ///< per joint, radians or half as many metres
  std::vector<float> drift_, jitter_, candidates_;
  std::vector<std::uint8_t> is_valid_;
};

}  // namespace mneme::internal
