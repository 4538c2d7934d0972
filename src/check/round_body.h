// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The space that a link reaches while it rolls about an axis.
#pragma once

#include "check/link_distances.h"
#include "geometry/swept_solids.h"

#include <array>
#include <limits>

namespace mneme::internal {

/// Bounds on how fast points of a body move while one joint does.
struct PointSpeeds {
  Transform X_AxisBody;  ///< pose of the body in a frame whose z axis is the joint's
  double rate = 1;       ///< radians or metres per unit of the joint
  bool is_prismatic = false;

  /// Metres per unit of the joint that a point of the body moves at most.
  [[nodiscard]] double of(const Vec3& point) const {
    return is_prismatic ? rate : rate * (X_AxisBody * point).head<2>().norm();
  }
  [[nodiscard]] double of(const Sphere& ball) const {
    return of(ball.center) + (is_prismatic ? 0 : rate * ball.radius);
  }
};

/// Metres that points of a body keep away: `least`, and what they move while a joint moves by
/// `change` units.
struct PointMargin {
  double least = 0;
  PointSpeeds speeds;
  double change = 0;

  template <class Place>
  [[nodiscard]] double of(const Place& place) const {
    return least + change * speeds.of(place);
  }
};

/// Distance of the link's farthest point from the z axis of a frame in which the link is at X.
[[nodiscard]] double radius_about_axis(const ExactLink& link, const Transform& X);

/// Reach of a link that rolls about an axis: in slices along the axis, the largest
/// distance from it.
class RoundBody {
 public:
  /// `X`: pose of the link in a frame whose z axis is the axis.
  RoundBody(const ExactLink& link, const Transform& X);

  /// True if no part of `solid` is closer than its margin; `X` is the pose of the solid's body. May
  /// be false for parts that are nearly so close.
  [[nodiscard]] bool is_clear_of(const SweptSolid& solid, const Transform& X,
                                 const PointMargin& margin) const;

  /// Middle of the axis.
  [[nodiscard]] Vec3 middle() const { return {0, 0, 0.5 * (low_ + high_)}; }
  /// Distance of the farthest point from the z axis of a frame in which the body is at X.
  [[nodiscard]] double reach_about(const Transform& X) const;

 private:
  static constexpr int kSlices = 32;

  [[nodiscard]] double edge_of(int slice) const { return low_ + (high_ - low_) * slice / kSlices; }
  void add(const Capsule& edge);
  [[nodiscard]] bool is_clear_of(const SweptSolid& solid, int part, const Transform& X,
                                 const PointMargin& margin, int splits) const;
  [[nodiscard]] bool is_beyond(double distance, double low, double high, double margin) const;
  [[nodiscard]] bool is_beyond(const Triangle& t, double margin, int splits) const;

  double low_ = std::numeric_limits<double>::infinity(), high_ = -low_;
  std::array<double, kSlices> radii_{};
};

}  // namespace mneme::internal
