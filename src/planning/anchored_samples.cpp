// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/anchored_samples.h"

#include <cmath>

namespace mneme::internal {
namespace {

constexpr double kAnchorShare = 0.8;
/// Radians: how far from the node a sample lies, whatever the number of joints.
constexpr double kAnchorDistance = 4;
/// Largest share of the way to the target by which samples are pulled.
constexpr double kMostPull = 0.5;
/// Pulled samples spread less: many easy problems have a path near the straight one.
constexpr float kPulledSpread = 0.6f;

double anchor_sigma(const PlannerRun& run) {
  const double joints = run.space().joint_count();
  return run.settings().anchor_sigma.value_or(kAnchorDistance / std::sqrt(joints));
}

}  // namespace

AnchoredSamples::AnchoredSamples(PlannerRun& run)
    : run_(run),
      rng_(run.make_rng(RngStream::anchors)),
      probability_(run.settings().anchor.value_or(kAnchorShare)),
      sigmas_(joint_deviations(run.checker().robot(), anchor_sigma(run))),
      towards_(sigmas_.size()) {}

SampleSource AnchoredSamples::next(std::span<const float> newest, std::span<float> q,
                                   std::span<const float> target) {
  const SampleSource source = run_.next_sample(q);
  if (source == kUniformSource && rng_.uniform() < probability_) replace(newest, target, q);
  run_.checker().project(q);
  run_.show_sample(q, source);
  return source;
}

void AnchoredSamples::replace(std::span<const float> newest, std::span<const float> target,
                              std::span<float> q) {
  float pull = 0, spread = 1;
  if (run_.is_early() && !target.empty()) {
    pull = static_cast<float>(kMostPull * rng_.uniform());
    spread = kPulledSpread;
    run_.space().difference(newest.data(), target.data(), towards_.data());
  }
  for (std::size_t j = 0; j < q.size(); ++j) {
    const float middle = newest[j] + pull * towards_[j];
    const float value = middle + spread * sigmas_[j] * rng_.bell();
    q[j] = run_.space().into_limits(static_cast<int>(j), value);
  }
}

}  // namespace mneme::internal
