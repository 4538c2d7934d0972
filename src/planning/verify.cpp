// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/verify.h"

#include <utility>

#include "planning/path_conversion.h"

namespace mneme {
namespace internal {

MotionVerifier::MotionVerifier(const CollisionChecker& checker, Verification verification,
                               std::function<bool()> must_stop)
    : checker_(checker), must_stop_(std::move(must_stop)) {
  // Links of planar arms are so thin that they pass through each other between two states, however
  // close.
  if (verification == Verification::motions || checker.robot().is_planar()) {
    sweep_.emplace(checker.robot(), checker.scene(), checker.margin());
  }
}

bool MotionVerifier::is_free(std::span<const float> from, std::span<const float> to, bool is_at_end,
                             CheckCounters& counters) const {
  const auto has_margin = [&](std::span<const float> q) {
    return checker_.is_motion_valid(q, q, counters, {1, kVerificationMargin});
  };
  const double margin =
      is_at_end && !(has_margin(from) && has_margin(to)) ? 0.0 : kVerificationMargin;
  if (!checker_.is_motion_valid(from, to, counters, {kVerificationRefinement, margin})) {
    return false;
  }
  const Configuration begin(from.begin(), from.end()), end(to.begin(), to.end());
  return !sweep_ || sweep_->is_free(begin, end, must_stop_);
}

int MotionVerifier::find_invalid_motion(const Path& path, CheckCounters& counters) const {
  if (path.size() < 2) return -1;
  std::vector<float> from = to_floats(path.front());
  for (std::size_t i = 1; i < path.size(); ++i) {
    std::vector<float> to = to_floats(path[i]);
    const bool is_at_end = i == 1 || i + 1 == path.size();
    if (!is_free(from, to, is_at_end, counters)) return static_cast<int>(i) - 1;
    from = std::move(to);
  }
  return -1;
}

}  // namespace internal

int find_invalid_motion(const CollisionChecker& checker, const Path& path, CheckCounters& counters,
                        Verification verification) {
  if (verification == Verification::none) return -1;
  return internal::MotionVerifier(checker, verification).find_invalid_motion(path, counters);
}

}  // namespace mneme
