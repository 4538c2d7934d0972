// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/path.h"

#include "base/as_index.h"
#include "path/waypoints.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>
#include <vector>

namespace mneme {
namespace {

constexpr double kTurnRounding = 1e-5;  ///< radians; more than single precision loses

}  // namespace

bool MotionVerifier::is_free(std::span<const float> from, std::span<const float> to,
                             MotionEnds ends, CheckCounters& counters, bool are_links_apart) const {
  if (verification_ == Verification::none) return true;
  if (!has_unique_direction(from, to)) return false;
  if (verification_ == Verification::motions) {
    const SweepDetail detail{kVerificationMargin, ends.is_first, ends.is_last, are_links_apart};
    return checker_.is_sweep_valid(from, to, counters, detail);
  }
  const auto lacks_margin = [&](std::span<const float> q) {
    return !checker_.is_motion_valid(q, q, counters, {1, kVerificationMargin});
  };
  const bool is_excused =
      (ends.is_first && lacks_margin(from)) || (ends.is_last && lacks_margin(to));
  return checker_.is_motion_valid(from, to, counters,
                                  {kVerificationRefinement, is_excused ? 0 : kVerificationMargin});
}

bool MotionVerifier::are_free(std::span<const float> states, MotionEnds ends,
                              CheckCounters& counters) const {
  const auto joints = internal::as_index(checker_.robot().joint_count());
  const auto row = [&](std::size_t i) { return states.subspan(i * joints, joints); };
  const std::size_t count = states.size() / joints;
  if (verification_ == Verification::motions) {
    for (std::size_t i = 1; i < count; ++i) {
      if (!has_unique_direction(row(i - 1), row(i))) return false;
    }
    return checker_.are_sweeps_valid(states, counters,
                                     {kVerificationMargin, ends.is_first, ends.is_last});
  }
  for (std::size_t i = 1; i < count; ++i) {
    const MotionEnds own{ends.is_first && i == 1, ends.is_last && i + 1 == count};
    if (!is_free(row(i - 1), row(i), own, counters)) return false;
  }
  return true;
}

bool MotionVerifier::has_unique_direction(std::span<const float> from,
                                          std::span<const float> to) const {
  const Robot& robot = checker_.robot();
  for (int i = 0; i < robot.joint_count(); ++i) {
    if (robot.group_joint(i).type != JointType::continuous) continue;
    const auto j = static_cast<std::size_t>(i);
    const double turn = std::remainder(double{to[j]} - double{from[j]}, 2 * std::numbers::pi);
    if (std::abs(turn) > std::numbers::pi - kTurnRounding) return false;
  }
  return true;
}

bool MotionVerifier::is_curve_free(std::span<const float> states, std::span<const float> bow,
                                   CheckCounters& counters) const {
  if (verification_ == Verification::none) return true;
  std::vector<float> least(states.begin(), states.begin() + std::ssize(bow)), most = least;
  for (std::size_t i = 0; i < states.size(); ++i) {
    least[i % bow.size()] = std::min(least[i % bow.size()], states[i]);
    most[i % bow.size()] = std::max(most[i % bow.size()], states[i]);
  }
  for (std::size_t i = bow.size(); i < states.size(); i += bow.size()) {
    const auto from = states.subspan(i - bow.size(), bow.size());
    if (!checker_.keeps_constraints(from, states.subspan(i, bow.size()), bow)) return false;
  }
  const double off = checker_.displacement_bound(least, most, bow);
  if (verification_ == Verification::states) {
    return checker_.is_chain_valid(states, counters,
                                   {kVerificationRefinement, kVerificationMargin + off});
  }
  // A motion that is proven free keeps half of the margin.
  const SweepDetail detail{kVerificationMargin + 2 * off};
  return checker_.are_sweeps_valid(states, counters, detail);
}

int MotionVerifier::find_invalid_motion(const Path& path, CheckCounters& counters) const {
  std::vector<float> from, to;
  for (std::size_t i = 0; i < path.size(); ++i) {
    from = std::exchange(to, internal::to_floats(checker_.robot(), path[i]));
    const MotionEnds ends{i == 1, i + 1 == path.size()};
    if (i > 0 && !is_free(from, to, ends, counters)) return static_cast<int>(i) - 1;
  }
  return -1;
}

int find_invalid_motion(const CollisionChecker& checker, const Path& path, CheckCounters& counters,
                        Verification verification) {
  return MotionVerifier(checker, verification).find_invalid_motion(path, counters);
}

}  // namespace mneme
