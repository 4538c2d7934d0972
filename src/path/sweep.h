// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Contact anywhere along a motion, not only at states of it.
#pragma once

#include "check/link_distances.h"

#include <functional>
#include <span>
#include <vector>

namespace mneme::internal {

/// Bounds how far the shapes of a robot move, and halves a motion until they are farther apart at
/// the middle of each part than they can come within it, in double precision. After conservative
/// advancement: Schwarzer, Saha and Latombe, DOI 10.1109/TRO.2004.838012. Const and parallel-safe.
class Sweep {
 public:
  /// Refers to its arguments. `margin`: metres to obstacles that count as contact.
  Sweep(const Robot& robot, const Scene& scene, double margin = 0);

  /// True if nothing touches along the straight motion, ends included, by more than kTolerance;
  /// links that do not move are not looked at. False, too, once `must_stop`, which may be empty,
  /// says so; it is asked at each state, in large scenes more often.
  [[nodiscard]] bool is_free(std::span<const double> from, std::span<const double> to,
                             const std::function<bool()>& must_stop = {}) const;

  static constexpr double kTolerance = 1e-5;  ///< metres; the accuracy of the kernels

 private:
  /// A link and an obstacle's shape, or two links.
  struct Pair {
    int link = 0;
    int other_link = 0;
    int speed = 0;      ///< index into Motion::speeds_
    int obstacle = -1;  ///< index into obstacles_; none for two links
  };
  class Motion;

  /// Metres between the two, less the margin; or, if they are more than `enough` apart anyway,
  /// anything above it.
  [[nodiscard]] double clearance(const Pair& pair, const PosedLinks& posed, double enough) const;

  const Robot& robot_;
  double margin_;
  LinkDistances links_;
  std::vector<double> reaches_;  ///< metres from the links' origins to their farthest points
  std::vector<ObstacleShape> obstacles_;
  std::vector<Pair> pairs_;  ///< those of two links first
};

}  // namespace mneme::internal
