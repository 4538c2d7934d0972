// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/check.h"

#include "check/link_distances.h"

#include <cmath>
#include <cstdint>

namespace mneme {
namespace {

/// The states of one robot in one scene.
class StateChecker {
 public:
  StateChecker(const Robot& robot, const Scene& scene)
      : robot_(robot),
        links_(robot),
        obstacles_(internal::obstacle_shapes(robot, scene)),
        pairs_(internal::link_pairs(robot, scene)) {}

  [[nodiscard]] bool is_free(const Configuration& q) const {
    return internal::is_free(links_, links_.posed(robot_.link_poses(q)), obstacles_, pairs_);
  }

 private:
  const Robot& robot_;
  internal::LinkDistances links_;
  std::vector<internal::ObstacleShape> obstacles_;
  std::vector<internal::LinkPair> pairs_;
};

/// Walks the states after `from`, up to and including `to`.
bool is_motion_free(const Robot& robot, const StateChecker& states, const Configuration& from,
                    const Configuration& to, double resolution) {
  const Configuration delta = robot.difference(from, to);
  const double length = robot.distance(from, to);
  const auto steps = static_cast<std::int64_t>(std::ceil(length / resolution));
  Configuration q = from;
  for (std::int64_t step = 1; step < steps; ++step) {
    const double fraction = static_cast<double>(step) / static_cast<double>(steps);
    for (std::size_t i = 0; i < q.size(); ++i) q[i] = from[i] + fraction * delta[i];
    if (!states.is_free(q)) return false;
  }
  return states.is_free(to);
}

}  // namespace

bool is_path_free(const Robot& robot, const Scene& scene, const std::vector<Configuration>& path,
                  double resolution) {
  if (path.empty() || !(resolution > 0)) return false;
  for (const Configuration& q : path) {
    if (robot.describe_violation(q, "waypoint")) return false;
  }
  const StateChecker states(robot, scene);
  if (!states.is_free(path.front())) return false;
  for (std::size_t i = 1; i < path.size(); ++i) {
    if (!is_motion_free(robot, states, path[i - 1], path[i], resolution)) return false;
  }
  return true;
}

}  // namespace mneme
