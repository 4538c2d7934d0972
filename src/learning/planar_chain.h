// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A planar arm as a chain of segments, for constructing configurations link by link.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "mneme/robot.h"

namespace mneme::internal {

using Vec2 = Eigen::Vector2d;

/// A serial arm in the plane z = 0 whose links are single capsules that start at their joint.
class PlanarChain {
 public:
  /// Error: a robot of another build.
  [[nodiscard]] static Result<PlanarChain> make(const Robot& robot);

  [[nodiscard]] int link_count() const { return static_cast<int>(lengths_.size()); }
  [[nodiscard]] double length(int link) const { return lengths_[static_cast<std::size_t>(link)]; }
  [[nodiscard]] double reach() const;

  /// Points 0 to link_count(): the base, then the far end of each link, at joint values `q`.
  void points(std::span<const double> q, std::vector<Vec2>& result) const;
  /// Joint values from the directions of the links, radians in the world; wrapped to [-pi, pi).
  [[nodiscard]] Configuration joint_values(std::span<const double> directions) const;

 private:
  std::vector<double> lengths_;
  std::vector<double> bends_;  ///< angle between a joint's x axis and its link
};

/// The segment between two circles, from surface to surface along the line of centres.
struct GapSegment {
  Vec2 a = Vec2::Zero(), b = Vec2::Zero();
};
[[nodiscard]] GapSegment gap_segment(std::span<const double> key);

/// True if the segments ab and cd share a point.
[[nodiscard]] bool do_segments_cross(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d);

}  // namespace mneme::internal
