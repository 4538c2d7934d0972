// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Planar arms as chains of segments, and their configurations in the gap between two circles.
#pragma once

#include "mneme/memory.h"

#include <Eigen/Core>

#include <optional>
#include <span>
#include <vector>

namespace mneme::internal {

using Vec2 = Eigen::Vector2d;

/// Share and standard deviation (radians) of samples around known means in local queries.
inline constexpr double kBootstrapLambda = 0.5, kBootstrapSigma = 0.1;

inline double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Joint limits, radians.
struct Limits {
  double lower = 0, upper = 0;

  [[nodiscard]] double width() const { return upper - lower; }
  [[nodiscard]] bool contains(double value) const { return lower <= value && value <= upper; }
};

/// A serial arm in the plane z = 0 whose links are single capsules that start at their joint.
class PlanarChain {
 public:
  /// Error: unsupported for other robots.
  [[nodiscard]] static Result<PlanarChain> make(const Robot& robot);

  [[nodiscard]] int link_count() const { return static_cast<int>(lengths_.size()); }
  [[nodiscard]] double length(int link) const { return lengths_[static_cast<std::size_t>(link)]; }
  [[nodiscard]] double reach() const;

  /// Points 0 to link_count(): the base, then the far end of each link, at joint values `q`.
  void points(std::span<const double> q, std::vector<Vec2>& result) const;
  /// Joint values from the links' directions in the world, radians. Wrapped to [-pi, pi), or
  /// shifted by a whole turn into the limits.
  [[nodiscard]] Configuration joint_values(std::span<const double> directions) const;

  /// Value of joint `link` for its link's `direction`, given the direction `before` of the link
  /// before it (0 for the first link).
  [[nodiscard]] double joint_value(int link, double direction, double before) const;
  /// Direction of `link` with its joint at `value`: the inverse of joint_value().
  [[nodiscard]] double direction(int link, double value, double before) const;
  [[nodiscard]] const Limits& limits(int link) const {
    return limits_[static_cast<std::size_t>(link)];
  }

 private:
  [[nodiscard]] double bend_before(int link) const {
    return link == 0 ? 0 : bends_[static_cast<std::size_t>(link) - 1];
  }

  std::vector<double> lengths_;
  std::vector<double> bends_;  ///< angle between a joint's x axis and its link
  std::vector<Limits> limits_;
};

/// The segment between two circles, from surface to surface along the line of centres.
struct GapSegment {
  Vec2 a = Vec2::Zero(), b = Vec2::Zero();
};
[[nodiscard]] GapSegment gap_segment(std::span<const double> key);

/// True if the segments ab and cd share a point.
[[nodiscard]] bool do_segments_cross(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d);

/// The first link that crosses the gap between the two circles, or -1.
[[nodiscard]] int first_crossing_link(const PlanarChain& chain, const PrimitiveKey& key,
                                      std::span<const double> q);
/// A random valid configuration whose first link through the gap is `first_link`. Nothing if
/// `attempts` tries fail.
[[nodiscard]] std::optional<Configuration> sample_threaded(const CollisionChecker& checker,
                                                           const PlanarChain& chain,
                                                           const PrimitiveKey& key, int first_link,
                                                           int attempts, Rng& rng);
/// Random valid configurations with the whole arm out of the gap: at most `count`, from `attempts`
/// tries in all.
[[nodiscard]] std::vector<Configuration> sample_outside(const CollisionChecker& checker,
                                                        const PlanarChain& chain,
                                                        const PrimitiveKey& key, int count,
                                                        int attempts, Rng& rng);

}  // namespace mneme::internal
