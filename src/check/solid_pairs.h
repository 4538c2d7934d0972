// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Links and obstacles that are checked by what the links' covers cover.
#pragma once

#include "mneme/robot.h"
#include "mneme/scene.h"

#include "check/link_distances.h"

#include <memory>
#include <span>
#include <vector>

namespace mneme::internal {

/// All pairs of a scene that are checked by solid (Obstacle::by_solid), in double precision. Covers
/// come first, so that exact distances are found only where these are close. Const and
/// parallel-safe.
class SolidPairs {
 public:
  /// Refers to `links`, which are those of the robot.
  SolidPairs(const Robot& robot, const LinkDistances& links, const Scene& scene);

  /// True if at `q` no pair is closer than `margin` metres.
  [[nodiscard]] bool are_apart(std::span<const float> q, double margin) const {
    return pairs_.empty() || are_all_apart(q, margin);
  }
  /// True if no pair comes closer than `margin`, and 1e-4 m besides, on the whole motion from
  /// `from` by `delta`: from each state that is looked at the motion goes on to where the links
  /// have moved by no more than they had room.
  [[nodiscard]] bool stay_apart(std::span<const float> from, std::span<const float> delta,
                                double margin) const {
    return pairs_.empty() || stay_all_apart(from, delta, margin);
  }

 private:
  struct Pair {
    int link = 0;
    std::shared_ptr<const Shape> shape;
    ObstacleShape obstacle;
  };
  [[nodiscard]] bool are_all_apart(std::span<const float> q, double margin) const;
  [[nodiscard]] bool stay_all_apart(std::span<const float> from, std::span<const float> delta,
                                    double margin) const;
  [[nodiscard]] PosedLinks pose(const Configuration& q) const;
  [[nodiscard]] double longest_way(int link, const Configuration& from,
                                   const Configuration& to) const;

  Robot robot_;
  const LinkDistances& links_;
  std::vector<Pair> pairs_;
};

}  // namespace mneme::internal
