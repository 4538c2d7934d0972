// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/anchored_samples.h"

#include <cmath>

namespace mneme::internal {
namespace {

/// Radians: how far from the node a sample lies, whatever the number of joints.
constexpr double kAnchorDistance = 4;

double anchor_sigma(const PlannerRun& run) {
  const double joints = run.space().joint_count();
  return run.settings().anchor_sigma.value_or(kAnchorDistance / std::sqrt(joints));
}

}  // namespace

AnchoredSamples::AnchoredSamples(PlannerRun& run)
    : run_(run),
      rng_(run.make_rng(RngStream::anchors)),
      probability_(run.settings().anchor),
      sigmas_(joint_deviations(run.checker().robot(), anchor_sigma(run))) {}

SampleSource AnchoredSamples::next(std::span<const float> newest, std::span<float> q) {
  const SampleSource source = run_.next_sample(q);
  if (source == kUniformSource && rng_.uniform() < probability_) {
    for (std::size_t j = 0; j < q.size(); ++j) {
      const float value = newest[j] + sigmas_[j] * rng_.bell();
      q[j] = run_.space().into_limits(static_cast<int>(j), value);
    }
  }
  run_.checker().project(q);
  run_.show_sample(q, source);
  return source;
}

}  // namespace mneme::internal
