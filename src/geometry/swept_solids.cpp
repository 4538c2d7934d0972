// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/swept_solids.h"

#include "base/as_index.h"
#include "geometry/part_distance.h"
#include "geometry/parts.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <limits>
#include <memory>
#include <type_traits>
#include <utility>

namespace mneme::internal {
namespace {

/// Metres: an interval on which parts move no farther is not halved any more.
constexpr double kFinestMotion = 5e-5;
/// Boxes whose gap in the middle of an interval is a larger share of their motion are proven apart
/// by a few halvings of the interval. Others are split.
constexpr double kHalvingRatio = 1.0 / 16;
/// Metres, added to limits of distances, so that contact is found and not cut off.
constexpr double kBeyondLimit = 1e-6;

AxisBox around(const Triangle& t) {
  return {t.a.cwiseMin(t.b).cwiseMin(t.c), t.a.cwiseMax(t.b).cwiseMax(t.c)};
}

Triangle moved(const Transform& X, const Triangle& t) { return {X * t.a, X * t.b, X * t.c}; }

std::shared_ptr<const BoxTree> tree_of_one(const Vec3& half_extents) {
  return std::make_shared<BoxTree>(std::vector<AxisBox>{{-half_extents, half_extents}});
}

/// A box by its middle and half of its extents.
struct CenteredBox {
  explicit CenteredBox(const AxisBox& box)
      : center(0.5 * (box.low + box.high)), half(0.5 * (box.high - box.low)) {}
  /// Distance of the farthest point from the origin.
  [[nodiscard]] double reach() const { return (center.cwiseAbs() + half).norm(); }

  Vec3 center, half;
};

/// An interval of the motion as the boxes of two solids need it.
struct Snapshot {
  Snapshot(const BodyMotion& motion, int index, const SweptSolid& a, const SweptSolid& b,
           double finest)
      : interval(index), half(motion.interval(index).half) {
    if (half <= finest) half = 0;
    const MovingPose& pose = motion.interval(index).pose;
    const Transform X_A = a.pose().inverse();
    X = X_A * pose.X_AB * b.pose();
    extent = X.rotation.cwiseAbs();
    if (half == 0) return;
    turn = X_A.rotation * pose.turn;
    speed =
        X_A.rotation * (pose.speed + pose.turn.cross(pose.X_AB.rotation * b.pose().translation));
    for (int axis = 0; axis < 3; ++axis) {
      spin_b.col(axis) = turn.cross(X.rotation.col(axis)).cwiseAbs();
      spin_a.col(axis) = (X.rotation.transpose() * turn.cross(Vec3::Unit(axis))).cwiseAbs();
    }
  }

  int interval;
  double half;                     ///< 0: only the middle counts.
  Transform X;                     ///< Pose of b's tree in the frame of a's tree.
  Eigen::Matrix3d extent;          ///< Extent of a box of b along the axes of a.
  Vec3 turn, speed;                ///< As in MovingPose, in the frame of a's tree.
  Eigen::Matrix3d spin_a, spin_b;  ///< Speeds of the ends of unit axes, seen from the other solid.
};

/// Searches the trees of two solids and the intervals of a motion together.
class SweptGap {
 public:
  /// Intervals on which parts move no farther than `finest_motion` metres are not halved.
  SweptGap(const SweptSolid& a, const SweptSolid& b, BodyMotion& motion, double margin,
           double finest, double finest_motion = kFinestMotion)
      : a_(a),
        b_(b),
        motion_(motion),
        margin_(margin),
        finest_(finest),
        finest_motion_(finest_motion),
        reach_(margin + a.radius() + b.radius()) {}

  [[nodiscard]] bool stay_apart() { return search(0, 0, {motion_, 0, a_, b_, finest_}); }

 private:
  /// Makes each snapshot once.
  const Snapshot& snapshot(int interval) {
    const std::size_t i = as_index(interval);
    if (i >= known_.size()) known_.resize(i + 1);
    if (known_[i] == nullptr) {
      known_[i] = std::make_unique<Snapshot>(motion_, interval, a_, b_, finest_);
    }
    return *known_[i];
  }

  /// True if the parts below two nodes stay apart on an interval.
  bool search(int i, int k, const Snapshot& at) {
    const BoxTree::Node &a = a_.tree().nodes()[as_index(i)], &b = b_.tree().nodes()[as_index(k)];
    const CenteredBox box_a(a.box), box_b(b.box);
    const Separation boxes = separate(box_a, box_b, at);
    if (boxes.is_proven) return true;
    const double size_a = box_a.half.squaredNorm(), size_b = box_b.half.squaredNorm();
    const double moved = boxes.moved;
    const bool is_fast = boxes.ratio > kHalvingRatio || moved * moved > std::max(size_a, size_b);
    if (moved > finest_motion_ && is_fast) return search_halves(i, k, at);
    if (a.right < 0 && b.right < 0) {
      const double least = leaf_distance(a, b, at, margin_ + moved);
      if (least > 0 && least >= margin_ + moved) return true;
      const bool is_certain = !(least > 0) || least < margin_ || moved <= finest_motion_;
      return !is_certain && search_halves(i, k, at);
    }
    const bool splits_a = b.right < 0 || (a.right >= 0 && size_a > size_b);
    Nodes near = splits_a ? Nodes{i + 1, k} : Nodes{i, k + 1};
    Nodes far = splits_a ? Nodes{a.right, k} : Nodes{i, b.right};
    // Contact ends the search.
    if (middle_distance2(far, at) < middle_distance2(near, at)) std::swap(near, far);
    return search(near.a, near.b, at) && search(far.a, far.b, at);
  }

  struct Nodes {
    int a = 0, b = 0;
  };
  [[nodiscard]] double middle_distance2(const Nodes& nodes, const Snapshot& at) const {
    const AxisBox& a = a_.tree().nodes()[as_index(nodes.a)].box;
    const AxisBox& b = b_.tree().nodes()[as_index(nodes.b)].box;
    return (at.X * Vec3(0.5 * (b.low + b.high)) - 0.5 * (a.low + a.high)).squaredNorm();
  }

  bool search_halves(int i, int k, const Snapshot& at) {
    const int first = motion_.halve(at.interval);
    return search(i, k, snapshot(first)) && search(i, k, snapshot(first + 1));
  }

  struct Separation {
    bool is_proven = false;
    double moved = 0;  ///< bound on how far points move against the other box, metres
    double ratio =
        -1;  ///< largest gap in the middle of the interval, as a share of the motion there
  };

  /// Separates two boxes on an interval by the axes of each.
  [[nodiscard]] Separation separate(const CenteredBox& a, const CenteredBox& b,
                                    const Snapshot& at) const {
    Separation result;
    const Vec3 to_b = at.X.rotation * b.center;
    const Vec3 apart = at.X.translation + to_b - a.center;
    const Vec3 gap_a = apart.cwiseAbs() - a.half - at.extent * b.half;
    Vec3 swept = Vec3::Zero();
    if (at.half > 0) {
      const Vec3 speed = at.speed + at.turn.cross(to_b);
      const double reach = b_.pose().translation.norm() + b.reach();
      swept = sweep(at.half, speed.cwiseAbs() + at.spin_b * b.half, motion_.of_b, reach);
    }
    if (update(gap_a, swept, at.half, result)) return result;
    const double moved = result.moved;
    const Vec3 gap_b =
        (at.X.rotation.transpose() * apart).cwiseAbs() - b.half - at.extent.transpose() * a.half;
    if (at.half > 0) {
      const Vec3 speed =
          at.X.rotation.transpose() * (at.speed + at.turn.cross(a.center - at.X.translation));
      const double reach = a_.pose().translation.norm() + a.reach();
      swept = sweep(at.half, speed.cwiseAbs() + at.spin_a * a.half, motion_.of_a, reach);
    }
    update(gap_b, swept, at.half, result);
    result.moved = std::min(result.moved, moved);
    return result;
  }

  /// Returns true if gaps along three axes prove the boxes apart although points move by `swept`.
  bool update(const Vec3& gap, const Vec3& swept, double half, Separation& result) const {
    result.is_proven = (gap - swept).cwiseMax(0.0).squaredNorm() > reach_ * reach_;
    if (half == 0) return result.is_proven;
    result.moved = swept.norm();
    const Eigen::Array3d ratios = (gap.array() - reach_) / swept.array().max(1e-12);
    result.ratio = std::max(result.ratio, ratios.maxCoeff());
    return result.is_proven;
  }

  /// Metres along each axis that points move within half an interval: by their speed in its middle
  /// and their acceleration, or by the bound of their speed if that is less.
  static Vec3 sweep(double half, const Vec3& speed, const MotionBound& bound, double reach) {
    const double bend = 0.5 * half * (bound.bend + reach * bound.bend_by_reach);
    const double most = bound.speed + reach * bound.speed_by_reach;
    return half * (speed.array() + bend).cwiseMin(most).matrix();
  }

  /// Metres between the parts of two leaves in the middle of an interval. Any value below `enough`
  /// if two parts are closer, otherwise any value of at least `enough`.
  double leaf_distance(const BoxTree::Node& a, const BoxTree::Node& b, const Snapshot& at,
                       double enough) const {
    const Transform X_ba = at.X.inverse();
    const double radii = a_.radius() + b_.radius();
    double least = enough + kBeyondLimit;
    for (int i = a.first; i < a.first + a.count && least >= enough; ++i) {
      const int own = a_.tree().order()[as_index(i)];
      const Triangle t = moved(X_ba, a_.triangle(own));
      const AxisBox box = around(t);
      const double own_radii = radii + a_.own_radius(own);
      const double reach = least + own_radii;
      if (distance2(box, b.box) > reach * reach) continue;
      for (int k = b.first; k < b.first + b.count && least >= enough; ++k) {
        const int other = b_.tree().order()[as_index(k)];
        const double thickness = own_radii + b_.own_radius(other), limit = least + thickness;
        if (b_.has_triangles() && distance2(box, around(b_.triangle(other))) > limit * limit) {
          continue;
        }
        const double apart = b_.distance_to(t, other, limit);
        // Where cores meet, contact is deeper than their radii say.
        least = std::min(least, apart > 0 ? apart - thickness : -thickness - kBeyondLimit);
      }
    }
    return least;
  }

  const SweptSolid &a_, &b_;
  BodyMotion& motion_;
  double margin_, finest_, finest_motion_, reach_;
  std::vector<std::unique_ptr<const Snapshot>> known_;  ///< by interval; null: not made yet
};

}  // namespace

int BodyMotion::halve(int index) {
  const int known = interval(index).first_half;
  if (known >= 0) return known;
  const double middle = interval(index).middle, half = 0.5 * interval(index).half;
  const int first = static_cast<int>(intervals_.size());
  add_interval(middle - half, half);
  add_interval(middle + half, half);
  return intervals_[as_index(index)].first_half = first;
}

SweptSolid::SweptSolid(const Shape& shape) {
  std::visit(
      [this](const auto& s) {
        using Kind = std::decay_t<decltype(s)>;
        if constexpr (std::is_same_v<Kind, Sphere>) {
          const Capsule ball{s.center, s.center, s.radius};
          *this = SweptSolid(std::span(&ball, 1));
        } else if constexpr (std::is_same_v<Kind, Capsule>) {
          *this = SweptSolid(std::span(&s, 1));
        } else if constexpr (std::is_same_v<Kind, Box>) {
          pose_ = s.pose;
          parts_ = Box{{}, s.half_extents};
          tree_ = tree_of_one(s.half_extents);
        } else if constexpr (std::is_same_v<Kind, Cylinder>) {
          pose_ = s.pose;
          parts_ = Cylinder{{}, s.radius, s.length};
          tree_ = tree_of_one({s.radius, s.radius, 0.5 * s.length});
        } else {
          pose_ = s.pose;
          radius_ = s.radius;
          tree_ = PartsAccess::tree(*s.parts);
          if constexpr (std::is_same_v<Kind, Mesh>) {
            parts_ = Triangles(s.parts, &s.parts->list());
          } else {
            parts_ = s.parts;
          }
        }
      },
      shape);
}

SweptSolid::SweptSolid(std::span<const Capsule> capsules) {
  std::vector<Triangle> axes;
  std::vector<AxisBox> boxes;
  for (const Capsule& capsule : capsules) {
    axes.push_back({capsule.a, capsule.b, capsule.b});
    boxes.push_back(box_of(capsule));
    radii_.push_back(capsule.radius);
  }
  parts_ = std::make_shared<const std::vector<Triangle>>(std::move(axes));
  tree_ = std::make_shared<BoxTree>(boxes);
}

double SweptSolid::distance_to(const Triangle& t, int part, double limit) const {
  return std::visit(
      [&](const auto& parts) {
        using Kind = std::decay_t<decltype(parts)>;
        if constexpr (std::is_same_v<Kind, Triangles>) {
          return distance_between(t, (*parts)[as_index(part)], limit);
        } else if constexpr (requires { parts->list(); }) {
          return distance_between(t, parts->list()[as_index(part)]);
        } else {
          return distance_between(t, parts);
        }
      },
      parts_);
}

bool stay_apart(const SweptSolid& a, const SweptSolid& b, BodyMotion& motion, double margin,
                double finest) {
  return SweptGap(a, b, motion, margin, finest).stay_apart();
}

bool stay_apart_as_whole(const SweptSolid& a, const SweptSolid& b, BodyMotion& motion,
                         double margin) {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  return SweptGap(a, b, motion, margin, 0, kAny).stay_apart();
}

}  // namespace mneme::internal
