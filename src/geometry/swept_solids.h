// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Contact between solids that move against each other: at one pose, and all along a motion.
#pragma once

#include "mneme/geometry.h"

#include "geometry/box_tree.h"

#include <memory>
#include <span>
#include <variant>
#include <vector>

namespace mneme::internal {

/// The pose of body B in the frame of body A at a state of a motion, and its change per unit of the
/// motion.
struct MovingPose {
  Transform X_AB;
  Vec3 turn = Vec3::Zero();   ///< angular velocity of B, radians, in A's frame
  Vec3 speed = Vec3::Zero();  ///< velocity of B's origin, metres, in A's frame
};

/// Bounds along a whole motion on a point of a body, `reach` metres from the body's origin.
struct MotionBound {
  double speed = 0, speed_by_reach = 0;  ///< metres per motion, and per metre of reach
  double bend = 0, bend_by_reach = 0;    ///< the same bounds of the acceleration
};

/// A motion of body B seen from body A, from share 0 to share 1. Caches the poses in the middle of
/// intervals, which are halved on demand. Belongs to one thread.
class BodyMotion {
 public:
  struct Interval {
    double middle = 0.5, half = 0.5;
    MovingPose pose;
    int first_half = -1;  ///< index of the first of its halves; the second follows
  };

  BodyMotion(const BodyMotion&) = delete;
  BodyMotion& operator=(const BodyMotion&) = delete;
  virtual ~BodyMotion() = default;

  /// Interval 0 is the whole motion, or a state if `half` is 0.
  [[nodiscard]] const Interval& interval(int index) const {
    return intervals_[static_cast<std::size_t>(index)];
  }
  /// Index of the first half of an interval.
  int halve(int index);

  MotionBound of_a, of_b;  ///< of A's points seen from B, and of B's points seen from A

 protected:
  BodyMotion() = default;
  /// Derived classes add interval 0 when they are constructed.
  void add_interval(double middle, double half) {
    intervals_.push_back({middle, half, at(middle)});
  }
  [[nodiscard]] virtual MovingPose at(double share) const = 0;

 private:
  std::vector<Interval> intervals_;
};

/// One shape, or several capsules, under a tree of boxes. Refers to the parts of compound shapes
/// and shares them.
class SweptSolid {
 public:
  /// A shape in the body's frame. A mesh is its surface.
  explicit SweptSolid(const Shape& shape);
  explicit SweptSolid(std::span<const Capsule> capsules);

  [[nodiscard]] const BoxTree& tree() const { return *tree_; }
  /// Pose, in the body, of the frame of the tree.
  [[nodiscard]] const Transform& pose() const { return pose_; }
  /// Metres by which parts exceed the boxes of the tree.
  [[nodiscard]] double radius() const { return radius_; }

  [[nodiscard]] bool has_triangles() const { return std::holds_alternative<Triangles>(parts_); }
  /// Triangle of a mesh, or the axis of a capsule as a triangle without area.
  [[nodiscard]] const Triangle& triangle(int part) const {
    return (*std::get<Triangles>(parts_))[static_cast<std::size_t>(part)];
  }
  /// Radius of a triangle or capsule that the tree's boxes include.
  [[nodiscard]] double own_radius(int part) const {
    return radii_.empty() ? 0 : radii_[static_cast<std::size_t>(part)];
  }
  /// Metres between a triangle in the frame of the tree and a part without any radius. Exact below
  /// `limit`, otherwise any larger value; 0 if they meet.
  [[nodiscard]] double distance_to(const Triangle& t, int part, double limit) const;

 private:
  using Triangles = std::shared_ptr<const std::vector<Triangle>>;

  Transform pose_;
  double radius_ = 0;
  std::vector<double> radii_;
  std::variant<Triangles, std::shared_ptr<const Parts<CloudPoint>>,
               std::shared_ptr<const Parts<Cube>>, Box, Cylinder>
      parts_;
  std::shared_ptr<const BoxTree> tree_;
};

/// True if no part of `a`, of triangles or capsules, comes closer than `margin` metres to a part of
/// `b` on the motion of their bodies. Motions that come closer than `margin` + 5e-5 m may fail.
/// A body enclosed by a surface is not in contact with it. Cost: prunes boxes by the space that
/// they sweep in an interval of the motion, and halves intervals only for boxes that are close;
/// microseconds where a few boxes are. After Tang, Kim and Manocha, "C2A: Controlled conservative
/// advancement", ICRA 2009.
/// `finest`: intervals whose half is at most this share of the motion are checked in their middle
/// only, and nothing is proven there.
[[nodiscard]] bool stay_apart(const SweptSolid& a, const SweptSolid& b, BodyMotion& motion,
                              double margin, double finest = 0);

/// As stay_apart(), but the motion is not halved: false unless the space that parts sweep on all of
/// it proves it. Cost: that of a single state.
[[nodiscard]] bool stay_apart_as_whole(const SweptSolid& a, const SweptSolid& b, BodyMotion& motion,
                                       double margin);

}  // namespace mneme::internal
