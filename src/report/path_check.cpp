// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/report.h"

#include <cmath>
#include <cstdint>

namespace mneme {
namespace {

/// Walks the states after `from`, up to and including `to`.
bool is_motion_free(const CollisionChecker& checker, const Configuration& from,
                    const Configuration& to, double resolution) {
  const Configuration delta = checker.robot().difference(from, to);
  const double length = checker.robot().distance(from, to);
  const auto steps = static_cast<std::int64_t>(std::ceil(length / resolution));
  Configuration q = from;
  for (std::int64_t step = 1; step < steps; ++step) {
    const double fraction = static_cast<double>(step) / static_cast<double>(steps);
    for (std::size_t i = 0; i < q.size(); ++i) q[i] = from[i] + fraction * delta[i];
    if (!checker.contacts(q).empty()) return false;
  }
  return checker.contacts(to).empty();
}

}  // namespace

bool is_path_free(const CollisionChecker& checker, const Path& path, double resolution) {
  if (path.empty() || !(resolution > 0)) return false;
  for (const Configuration& q : path) {
    if (checker.robot().describe_violation(q, "waypoint")) return false;
  }
  if (!checker.contacts(path.front()).empty()) return false;
  for (std::size_t i = 1; i < path.size(); ++i) {
    if (!is_motion_free(checker, path[i - 1], path[i], resolution)) return false;
  }
  return true;
}

}  // namespace mneme
