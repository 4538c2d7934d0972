// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// How far a state is from contact, by the exact distances of geometry.h alone.
#pragma once

#include "mneme/robot.h"
#include "mneme/scene.h"

#include "robot/kinematics.h"

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

namespace mneme::test {

/// The shapes of a link as capsules (a sphere is one of length zero) in the root link's frame.
inline std::vector<Capsule> capsules_of(const Link& link, const Transform& X_WL) {
  std::vector<Capsule> result;
  for (const Sphere& s : link.spheres) {
    result.push_back({X_WL * s.center, X_WL * s.center, s.radius});
  }
  for (const Capsule& c : link.capsules) result.push_back({X_WL * c.a, X_WL * c.b, c.radius});
  return result;
}

/// Least distance between the surfaces of two links; negative where they overlap.
inline double gap_between(const std::vector<Capsule>& first, const std::vector<Capsule>& second) {
  double least = std::numeric_limits<double>::infinity();
  for (const Capsule& p : first) {
    for (const Capsule& q : second) {
      least = std::min(least, segment_distance(p.a, p.b, q.a, q.b) - p.radius - q.radius);
    }
  }
  return least;
}

/// The same between a link and an obstacle's shapes.
inline double gap_between(const std::vector<Capsule>& link, const Obstacle& obstacle) {
  double least = std::numeric_limits<double>::infinity();
  for (const Capsule& own : link) {
    for (const Shape& shape : obstacle.shapes) {
      least = std::min(least, distance_to_segment(own.a, own.b, shape) - own.radius);
    }
  }
  return least;
}

inline bool may_touch(const Link& link, const Obstacle& obstacle) {
  return std::ranges::count(obstacle.may_touch, link.name) > 0;
}

/// Least gap at `q` of anything that moves and may not touch, with `margin` metres taken off those
/// to obstacles: the state is free of contact if it is not negative.
inline double clearance(const Robot& robot, const Scene& scene, std::span<const double> q,
                        double margin = 0) {
  const std::vector<Transform> poses = robot.link_poses(q);
  std::vector<std::vector<Capsule>> shapes;
  const std::vector<bool> is_moving = internal::find_moving_links(robot);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    shapes.push_back(capsules_of(robot.links()[i], poses[i]));
    for (const Obstacle& obstacle : scene.obstacles) {
      if (!is_moving[i] || may_touch(robot.links()[i], obstacle)) continue;
      least = std::min(least, gap_between(shapes.back(), obstacle) - margin);
    }
  }
  for (const auto& [a, b] : robot.self_pairs()) {
    least = std::min(least, gap_between(shapes[static_cast<std::size_t>(a)],
                                        shapes[static_cast<std::size_t>(b)]));
  }
  return least;
}

/// The same for a row of floats.
inline double clearance(const Robot& robot, const Scene& scene, std::span<const float> q,
                        double margin = 0) {
  return clearance(robot, scene, Configuration(q.begin(), q.end()), margin);
}

}  // namespace mneme::test
