// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/check.h"

#include "base/as_index.h"
#include "base/threads.h"
#include "check/link_distances.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace mneme {
namespace {

using internal::as_index;

/// Calls `visit` for states of the path, at most `resolution` apart, until it returns false.
/// Returns true if it never did.
template <class Visit>
bool visit_states(const Robot& robot, const std::vector<Configuration>& path, double resolution,
                  const Visit& visit) {
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i > 0) {
      const Configuration& from = path[i - 1];
      const Configuration delta = robot.difference(from, path[i]);
      const double length = robot.distance(from, path[i]);
      const auto steps = static_cast<std::int64_t>(std::ceil(length / resolution));
      Configuration q = from;
      for (std::int64_t step = 1; step < steps; ++step) {
        const double share = static_cast<double>(step) / static_cast<double>(steps);
        for (std::size_t j = 0; j < q.size(); ++j) q[j] = from[j] + share * delta[j];
        if (!visit(q)) return false;
      }
    }
    if (!visit(path[i])) return false;
  }
  return true;
}

}  // namespace

bool is_path_free(const Robot& robot, const Scene& scene, const std::vector<Configuration>& path,
                  double resolution) {
  if (path.empty() || !(resolution > 0)) return false;
  for (const Configuration& q : path) {
    if (!robot.is_configuration(q)) return false;
  }
  const internal::LinkDistances links(robot);
  const auto obstacles = internal::obstacle_shapes(robot, scene);
  const auto pairs = internal::link_pairs(robot, scene);
  return visit_states(robot, path, resolution, [&](const Configuration& q) {
    internal::poll_interrupt();
    return internal::is_free(links, links.posed(robot.link_poses(q)), obstacles, pairs);
  });
}

double tilt(const Robot& robot, const OrientationConstraint& constraint,
            std::span<const double> q) {
  const Transform X_RL = robot.link_poses(q)[as_index(*robot.find_link(constraint.link))];
  const Vec3 axis = X_RL.rotation * constraint.axis;
  return std::atan2(axis.cross(constraint.up).norm(), axis.dot(constraint.up));
}

double largest_tilt(const Robot& robot, const OrientationConstraint& constraint,
                    const std::vector<Configuration>& path, double resolution) {
  if (!(resolution > 0)) return std::numeric_limits<double>::infinity();
  double largest = 0;
  visit_states(robot, path, resolution, [&](const Configuration& q) {
    largest = std::max(largest, tilt(robot, constraint, q));
    return true;
  });
  return largest;
}

}  // namespace mneme
