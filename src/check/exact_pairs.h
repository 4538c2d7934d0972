// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Links that are checked against obstacles and other links by exact geometry.
#pragma once

#include "mneme/robot.h"
#include "mneme/scene.h"

#include "check/link_distances.h"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace mneme::internal {

/// All pairs of a scene that are checked by exact geometry (Obstacle::exact_links,
/// Scene::exact_pairs), in double precision. Spheres come first, so that exact distances are found
/// only where these are close. Const and parallel-safe.
class ExactPairs {
 public:
  /// Refers to `links`, which are those of the robot. Obstacles are inflated by `margin` metres.
  ExactPairs(const Robot& robot, const LinkDistances& links, const Scene& scene, double margin);

  [[nodiscard]] bool empty() const { return pairs_.empty(); }
  /// True if at `q` no pair touches.
  [[nodiscard]] bool are_apart(std::span<const float> q) const;
  /// True if no pair comes closer than `extra` metres on the whole motion from `from` by `delta`,
  /// nor than 1e-4 m more at the states that are looked at: around each of them the motion is free
  /// where the links have moved by no more than they had room.
  [[nodiscard]] bool stay_apart(std::span<const float> from, std::span<const float> delta,
                                double extra) const;

 private:
  /// Of a link and a shape of an obstacle, or of two links.
  struct Pair {
    int link = 0;
    double margin = 0;
    std::shared_ptr<const Shape> shape = {};
    ObstacleShape obstacle = {};
    LinkPair links = {};
  };
  [[nodiscard]] double between(const PosedLinks& posed, const Pair& pair, double enough) const;
  [[nodiscard]] double room(const PosedLinks& posed, const Pair& pair, double margin,
                            double most) const;
  [[nodiscard]] PosedLinks pose(const Configuration& q) const;
  [[nodiscard]] double displacement_bound(const Pair& pair, const Configuration& from,
                                          const Configuration& to) const;
  [[nodiscard]] double displacement_bound(int link, std::span<const int> joints,
                                          const std::vector<double>& from,
                                          const std::vector<double>& to) const;

  Robot robot_;
  const LinkDistances& links_;
  std::vector<Pair> pairs_;
};

}  // namespace mneme::internal
