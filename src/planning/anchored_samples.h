// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Samples to grow towards.
#pragma once

#include "planning/planner_run.h"

#include <span>
#include <vector>

namespace mneme::internal {

/// Replaces uniform samples, with the probability of the settings, by samples around the newest
/// node, where the search is. Similar to expansive trees: Hsu, Latombe and Motwani,
/// DOI 10.1142/S0218195999000285. Not thread-safe.
class AnchoredSamples {
 public:
  explicit AnchoredSamples(PlannerRun& run);

  /// Early in the search, samples are pulled towards `target`, unless it is empty.
  SampleSource next(std::span<const float> newest, std::span<float> q,
                    std::span<const float> target = {});

 private:
  void replace(std::span<const float> newest, std::span<const float> target, std::span<float> q);

  PlannerRun& run_;
  Rng rng_;
  double probability_;
  std::vector<float> sigmas_;   ///< per joint
  std::vector<float> towards_;  ///< from the newest node to the target
};

}  // namespace mneme::internal
