// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/escape_walk.h"

#include "base/lengths.h"

#include <cmath>

namespace mneme::internal {
namespace {

constexpr double kPlanarShare = 0.7, kSpatialShare = 0.2;
constexpr std::uint64_t kPlanarStart = 0, kSpatialStart = 3000;
constexpr int kLongestWalk = 30;
constexpr int kCandidates = 16;  ///< per step: a vector costs as much as one state
// Relative to the limb's length.
constexpr double kLeastStep = 0.01, kMostStep = 0.05;
constexpr double kClearance = 0.01;
/// Radians over a walk as long as the limb.
constexpr double kLeastDrift = 0.5, kMostDrift = 5;
/// Jitter of the last candidate, relative to the pull; the others have less.
constexpr double kJitter = 1;

}  // namespace

EscapeWalk::EscapeWalk(PlannerRun& run) : run_(run), rng_(run.make_rng(RngStream::walks)) {
  const bool is_planar = run.checker().robot().is_planar();
  const PlanSettings& settings = run.settings();
  share_ = settings.walk.value_or(is_planar ? kPlanarShare : kSpatialShare);
  first_iteration_ = settings.walk_after.value_or(is_planar ? kPlanarStart : kSpatialStart);
}

void EscapeWalk::prepare() {
  if (!drift_sizes_.empty()) return;
  limbs_ = run_.checker().limbs();
  if (limbs_.empty()) share_ = 0;
  drift_sizes_ = joint_deviations(run_.checker().robot(), 1);
  const std::size_t joints = run_.start().size();
  drift_.resize(joints);
  jitter_.resize(3 * kCandidates);
  candidates_.resize(kCandidates * joints);
  is_valid_.resize(kCandidates);
}

bool EscapeWalk::is_due() {
  if (run_.iterations() < first_iteration_) return false;
  prepare();
  return share_ >= 1 || static_cast<double>(work_) < share_ * static_cast<double>(run_.work());
}

int EscapeWalk::extend(Tree& tree) {
  prepare();
  begin();
  const std::uint64_t before = run_.work();
  int last = -1;
  int node = tree.size() - 1;
  for (int step = 0; step < kLongestWalk && node >= 0 && !run_.must_stop(); ++step) {
    node = advance(tree, node);
    if (node >= 0) last = node;
  }
  work_ += run_.work() - before;
  return last;
}

void EscapeWalk::begin() {
  const auto log_uniform = [this](double least, double most) {
    return least * std::pow(most / least, rng_.uniform());
  };
  step_.limb = static_cast<int>(rng_.index(static_cast<std::uint32_t>(limbs_.size())));
  const LimbInfo& limb = limbs_[static_cast<std::size_t>(step_.limb)];
  step_.pulled_points = 1 + static_cast<int>(rng_.index(static_cast<std::uint32_t>(limb.points)));
  step_.length = static_cast<float>(limb.length * log_uniform(kLeastStep, kMostStep));
  step_.clearance = static_cast<float>(limb.length * kClearance);
  const auto drift = static_cast<float>(log_uniform(kLeastDrift, kMostDrift) / limb.length);
  for (std::size_t j = 0; j < drift_.size(); ++j) {
    drift_[j] = drift * drift_sizes_[j] * rng_.bell();
  }
  step_.drift = drift_;
  step_.jitter = jitter_;
}

/// Random directions; their size grows with the candidate's number, so that the first go straight.
void EscapeWalk::sample_jitter() {
  for (int i = 0; i < kCandidates; ++i) {
    const std::span<float> v(jitter_.data() + 3 * i, 3);
    for (float& value : v) value = rng_.bell();
    const float norm = length_of(v[0], v[1], v[2]) + 1e-6f;
    const auto size = static_cast<float>(kJitter * i / (kCandidates - 1));
    for (float& value : v) value *= size / norm;
  }
}

int EscapeWalk::advance(Tree& tree, int node) {
  sample_jitter();
  run_.walk(tree[node], step_, candidates_);
  run_.check_states(candidates_, is_valid_);
  const std::size_t joints = drift_.size();
  for (std::size_t i = 0; i < is_valid_.size(); ++i) {
    const std::span<const float> end(candidates_.data() + i * joints, joints);
    if (is_valid_[i] != 0 && run_.is_motion_valid(tree[node], end)) return tree.add(end, node);
  }
  return -1;
}

}  // namespace mneme::internal
