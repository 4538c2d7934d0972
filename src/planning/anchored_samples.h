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

  SampleSource next(std::span<const float> newest, std::span<float> q);

 private:
  PlannerRun& run_;
  Rng rng_;
  double probability_;
  std::vector<float> sigmas_;  ///< per joint
};

}  // namespace mneme::internal
