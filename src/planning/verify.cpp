// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/planning.h"
#include "planning/path_conversion.h"
#include "planning/verify.h"

namespace mneme {
namespace internal {

bool is_motion_verified(const CollisionChecker& checker, std::span<const float> from,
                        std::span<const float> to, bool is_at_end, CheckCounters& counters) {
  const auto has_margin = [&](std::span<const float> q) {
    return checker.is_motion_valid(q, q, counters, {1, kVerificationMargin});
  };
  const double margin =
      is_at_end && !(has_margin(from) && has_margin(to)) ? 0.0 : kVerificationMargin;
  return checker.is_motion_valid(from, to, counters, {kVerificationRefinement, margin});
}

}  // namespace internal

int find_invalid_motion(const CollisionChecker& checker, const Path& path,
                        CheckCounters& counters) {
  if (path.empty()) return -1;
  std::vector<float> from = internal::to_floats(path.front());
  for (std::size_t i = 1; i < path.size(); ++i) {
    std::vector<float> to = internal::to_floats(path[i]);
    const bool is_at_end = i == 1 || i + 1 == path.size();
    if (!internal::is_motion_verified(checker, from, to, is_at_end, counters))
      return static_cast<int>(i) - 1;
    from = std::move(to);
  }
  return -1;
}

}  // namespace mneme
