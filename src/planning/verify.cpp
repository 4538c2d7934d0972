// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/verify.h"

#include "planning/path_conversion.h"

namespace mneme {
namespace internal {

MotionVerifier::MotionVerifier(const CollisionChecker& checker) : checker_(checker) {
  if (checker.robot().is_planar()) sweep_.emplace(checker.robot(), checker.scene());
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
  return !sweep_ || sweep_->is_free(begin, end);
}

}  // namespace internal

int find_invalid_motion(const CollisionChecker& checker, const Path& path,
                        CheckCounters& counters) {
  if (path.size() < 2) return -1;
  const internal::MotionVerifier verifier(checker);
  std::vector<float> from = internal::to_floats(path.front());
  for (std::size_t i = 1; i < path.size(); ++i) {
    std::vector<float> to = internal::to_floats(path[i]);
    const bool is_at_end = i == 1 || i + 1 == path.size();
    if (!verifier.is_free(from, to, is_at_end, counters)) return static_cast<int>(i) - 1;
    from = std::move(to);
  }
  return -1;
}

}  // namespace mneme
