// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Contacts of groups of the robot's shapes, and of two bodies, one pose per lane.
#if defined(MNEME_COLLISION_PAIR_CHECKER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MNEME_COLLISION_PAIR_CHECKER_INL_H_
#undef MNEME_COLLISION_PAIR_CHECKER_INL_H_
#else
#define MNEME_COLLISION_PAIR_CHECKER_INL_H_
#endif

#include <algorithm>
#include <cstdint>

#include "tables/distance-inl.h"
#include "collision/kinematics-inl.h"
#include "collision/margins-inl.h"
#include "tables/tables.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {

HWY_INLINE M no_hit() { return hn::MaskFromVec(hn::Zero(Tag())); }

/// The lanes that are hit so far. With `kIsMotion` a hit in any lane is final; otherwise all lanes
/// must be hit before the rest can be skipped.
template <bool kIsMotion>
struct Verdict {
  // A default member initialiser would be compiled for the baseline instruction set.
  HWY_INLINE Verdict() : hit(no_hit()) {}

  M hit;

  /// Returns 1 if `mask` holds in a lane that is not hit yet, otherwise 0. An int, because callers
  /// add it to a count instead of branching unpredictably.
  [[nodiscard]] HWY_INLINE int is_any_open(M mask) const {
    return !hn::AllFalse(Tag(), kIsMotion ? mask : hn::AndNot(hit, mask));
  }
  HWY_INLINE bool add(M mask) {
    hit = hn::Or(hit, mask);
    return kIsMotion ? !hn::AllFalse(Tag(), hit) : hn::AllTrue(Tag(), hit);
  }
};

/// The spheres of a group.
struct PosedSpheres {
  V3 centers[kGroupSize];
};

HWY_INLINE PosedSpheres posed(const RobotTables& robot, const GroupRow& group, const Pose& pose) {
  PosedSpheres result;
  for (int i = 0; i < kGroupSize; ++i) {
    result.centers[i] = transform_point(pose, robot.spheres[group.begin + i].center);
  }
  return result;
}

HWY_INLINE Segment posed(const CapsuleRow& capsule, const Pose& pose) {
  const V zero = hn::Zero(Tag());
  return {add_sparse(pose, capsule.a, pose.origin),
          add_sparse(pose, capsule.along, {zero, zero, zero}), splat(capsule.inverse_length2)};
}

/// Lanes in which a sphere of the group comes closer than `extra`, given squared distances.
template <class Margin, class Distance2>
HWY_INLINE M find_hits(const RobotTables& robot, const GroupRow& group, const PosedSpheres& spheres,
                       Margin extra, const Distance2& distance2) {
  M hit = no_hit();
  for (int i = 0; i < kGroupSize; ++i) {
    const V reach = lanes_of(sum(robot.spheres[group.begin + i].radius, extra));
    hit = hn::Or(hit, hn::Lt(distance2(spheres.centers[i]), hn::Mul(reach, reach)));
  }
  return hit;
}

/// Number of clusters of a body that are checked together against the clusters of another.
constexpr int kMostRuns = 32;

/// Checks two bodies in the frame of the second, which then is the same in all lanes. First checks
/// each body's ball against the other's box, because long bodies fill little of their balls. Then
/// checks clusters of the first against the second's box, cluster against cluster, and group
/// against group.
template <bool kIsMotion, class Margin, class Margins>
class PairChecker {
 public:
  HWY_INLINE PairChecker(const RobotTables& robot, const BodyPairRow& pair, Margin margin,
                         const Margins& margins, Verdict<kIsMotion>& verdict)
      : robot_(robot),
        pair_(pair),
        second_(robot.bodies[pair.second]),
        margin_(margin),
        margins_(margins),
        verdict_(verdict) {}

  /// `centers` are those of the bodies' balls. Returns true as soon as the verdict is final.
  HWY_INLINE bool check(const Pose& first, const Pose& second, const V3* centers) {
    const BodyRow& body = robot_.bodies[pair_.first];
    if (!reaches_box(second_, body.ball.radius,
                     into_frame(second, centers[pair_.first] - second.origin)) ||
        !reaches_box(body, second_.ball.radius,
                     into_frame(first, centers[pair_.second] - first.origin))) {
      return false;
    }
    pose_ = seen_from(second, first);
    frame_ = &second;
    Run runs[kMostRuns];
    for (int begin = pair_.begin; begin < pair_.end;) {
      int count = 0;
      while (begin < pair_.end && count < kMostRuns) {
        const bool is_near = start_run(begin, runs[count]);
        begin = runs[count].end;
        count += is_near;
      }
      if (count > 0) find_near_clusters(transform_point(pose_, body.ball.center), runs, count);
      for (int i = 0; i < count; ++i) {
        for (int k = runs[i].begin; k < runs[i].end && runs[i].near != 0; ++k) {
          if (hits_groups(robot_.group_pairs[k], runs[i].near)) return true;
        }
      }
    }
    return false;
  }

 private:
  /// Pairs of groups whose first groups are of one cluster. `near` has a bit for each cluster of
  /// the second body that is near that cluster (bit_of).
  struct Run {
    int begin, end;
    V3 center;
    float radius;
    std::uint64_t near;
  };

  static HWY_INLINE V3 into_frame(const Pose& frame, const V3& v) {
    return {dot(frame.axes[0], v), dot(frame.axes[1], v), dot(frame.axes[2], v)};
  }
  static HWY_INLINE Pose seen_from(const Pose& frame, const Pose& pose) {
    return {{into_frame(frame, pose.axes[0]), into_frame(frame, pose.axes[1]),
             into_frame(frame, pose.axes[2])},
            into_frame(frame, pose.origin - frame.origin)};
  }
  /// The axis of a capsule of the second body.
  static HWY_INLINE Segment axis_of(const CapsuleRow& capsule) {
    return {splat(capsule.a), splat(capsule.along), splat(capsule.inverse_length2)};
  }
  /// True if in an open lane a squared distance is less than `radius` plus the margin, squared.
  [[nodiscard]] HWY_INLINE bool is_any_open(V distance2, float radius) const {
    return verdict_.is_any_open(is_below(distance2, squared(sum(radius, margin_))));
  }
  /// Clusters from the 64th on share the last bit.
  static constexpr int kLastBit = 63;
  [[nodiscard]] HWY_INLINE std::uint64_t bit_of(int cluster) const {
    return std::uint64_t{1} << std::min(cluster - second_.cluster_begin, kLastBit);
  }

  /// True if a ball, with its centre in the body's frame, comes near the body's box in any lane.
  [[nodiscard]] HWY_INLINE bool reaches_box(const BodyRow& body, float radius,
                                            const V3& center) const {
    const V distance2 = point_box(center - splat(body.box_center), splat(body.box_half_extents));
    return is_any_open(distance2, radius);
  }

  /// Returns false if the run is far from the second body.
  HWY_INLINE bool start_run(int begin, Run& run) const {
    const int cluster = robot_.groups[robot_.group_pairs[begin].first].cluster;
    run.begin = begin;
    run.end = begin + 1;
    while (run.end < pair_.end &&
           robot_.groups[robot_.group_pairs[run.end].first].cluster == cluster) {
      ++run.end;
    }
    const Ball& ball = robot_.clusters[cluster].ball;
    run.center = transform_point(pose_, ball.center);
    run.radius = ball.radius;
    return reaches_box(second_, ball.radius, run.center);
  }

  /// Capsules are compared by their axes: balls around long ones are poor bounds. `center` is that
  /// of the first body's ball: most clusters of a large second body are far from all of the first.
  HWY_INLINE void find_near_clusters(const V3& center, Run* runs, int count) const {
    const float body_radius = robot_.bodies[pair_.first].ball.radius;
    for (int i = 0; i < count; ++i) runs[i].near = 0;
    for (int c = second_.cluster_begin; c < second_.cluster_end; ++c) {
      const std::uint64_t bit = bit_of(c);
      const ClusterRow& cluster = robot_.clusters[c];
      const auto mark = [&](float radius, const auto& distance2) {
        if (count > 2 && !is_any_open(distance2(center), radius + body_radius)) return;
        for (int i = 0; i < count; ++i) {
          const V from_run2 = distance2(runs[i].center);
          runs[i].near |= is_any_open(from_run2, radius + runs[i].radius) ? bit : 0;
        }
      };
      const GroupRow& group = robot_.groups[cluster.begin];
      if (group.is_capsule) {
        const CapsuleRow& capsule = robot_.capsules[group.begin];
        const Segment axis = axis_of(capsule);
        mark(capsule.radius, [&](const V3& p) { return point_segment(p, axis); });
      } else {
        const V3 middle = splat(cluster.ball.center);
        mark(cluster.ball.radius, [&](const V3& p) { return squared_norm(p - middle); });
      }
    }
  }

  /// Checks a group of the first body against the near clusters of the second.
  HWY_INLINE bool hits_groups(const GroupPairRow& row, std::uint64_t near) const {
    const GroupRow& first = robot_.groups[row.first];
    const V3 center = transform_point(pose_, first.ball.center);
    if (!reaches_box(second_, first.ball.radius, center)) return false;
    PosedSpheres spheres;
    if (!first.is_capsule) spheres = posed(robot_, first, pose_);
    for (; near != 0; near &= near - 1) {
      const int bit = __builtin_ctzll(near);
      const int begin = second_.cluster_begin + bit;
      const int end = bit == kLastBit ? second_.cluster_end : begin + 1;
      for (int c = begin; c < end; ++c) {
        if (hits_cluster(first, center, spheres, row, robot_.clusters[c])) return true;
      }
    }
    return false;
  }

  /// Checks a group, with its ball's centre, against those groups of a cluster that are in `row`.
  HWY_INLINE bool hits_cluster(const GroupRow& first, const V3& center, const PosedSpheres& spheres,
                               const GroupPairRow& row, const ClusterRow& cluster) const {
    const auto is_near = [&](const Ball& ball) {
      return is_any_open(squared_norm(center - splat(ball.center)),
                         ball.radius + first.ball.radius);
    };
    const int begin = std::max(cluster.begin, row.second_begin);
    const int end = std::min(cluster.end, row.second_end);
    if (begin >= end || (end - begin > 1 && !is_near(cluster.ball))) return false;
    for (int g = begin; g < end; ++g) {
      const GroupRow& second = robot_.groups[g];
      if (!second.is_capsule && !is_near(second.ball)) continue;
      const M hit = first.is_capsule ? find_capsule_hits(first, second)
                                     : find_sphere_hits(first, spheres, second);
      if (verdict_.add(hit)) return true;
    }
    return false;
  }

  HWY_NOINLINE M find_sphere_hits(const GroupRow& first, const PosedSpheres& spheres,
                                  const GroupRow& second) const {
    if (second.is_capsule) {
      const CapsuleRow& capsule = robot_.capsules[second.begin];
      const Segment axis = axis_of(capsule);
      const auto reach = sum(capsule.radius, margin_);
      const V3 center = transform_point(pose_, first.ball.center);
      const V from_axis2 = point_segment(center, axis);
      if (!is_any_open(from_axis2, first.ball.radius + capsule.radius)) return no_hit();
      const M hit = find_hits(robot_, first, spheres, reach,
                              [&](const V3& p) { return point_segment(p, axis); });
      return keep_reached(first, spheres, axis, capsule.radius, hit);
    }
    M hit = no_hit();
    for (int i = 0; i < kGroupSize; ++i) {
      const Ball& ball = robot_.spheres[second.begin + i];
      const V3 center = splat(ball.center);
      const auto distance2 = [&](const V3& p) { return squared_norm(p - center); };
      const auto extra = sum(ball.radius, margin_);
      const M found = find_hits(robot_, first, spheres, extra, distance2);
      hit = hn::Or(hit, keep_reached(first, spheres, point_at(center), ball.radius, found));
    }
    return hit;
  }

  static HWY_INLINE Segment point_at(const V3& center) {
    const V zero = hn::Zero(Tag());
    return {center, {zero, zero, zero}, zero};
  }

  /// Returns those lanes of `hit` in which a part of each body may move up to the other. Axes are
  /// in the frame of the second body.
  HWY_NOINLINE M keep_reached(const Segment& first, const Segment& second, float radii,
                              M hit) const {
    const V3 between = between_segments(second, first);
    const V apart2 = squared_norm(between);
    const M near = hn::And(hit, hn::Lt(apart2, lanes_of(squared(sum(radii, margin_)))));
    if (hn::AllFalse(Tag(), near)) return near;
    const auto turned = [&](const V3& v) {
      return mul_add(v.x, frame_->axes[0], mul_add(v.y, frame_->axes[1], v.z * frame_->axes[2]));
    };
    const auto place = [&](const V3& v) { return frame_->origin + turned(v); };
    PairAxes axes{{place(first.a), place(first.a + first.u)},
                  {place(second.a), place(second.a + second.u)},
                  {},
                  hn::Sqrt(apart2),
                  radii};
    axes.normal = hn::Div(splat(1.0f), hn::Max(axes.apart, splat(1e-9f))) * turned(between);
    return margins_.find_reached(pair_, axes, near);
  }

  /// The same for the spheres of a group.
  HWY_INLINE M keep_reached(const GroupRow& first, const PosedSpheres& spheres,
                            const Segment& second, float radius, M hit) const {
    if constexpr (Margins::kAreLinksDirected) {
      if (hn::AllFalse(Tag(), hit)) return hit;
      M reached = no_hit();
      for (int i = 0; i < kGroupSize; ++i) {
        const float radii = radius + robot_.spheres[first.begin + i].radius;
        const M found = keep_reached(point_at(spheres.centers[i]), second, radii, hit);
        reached = hn::Or(reached, found);
      }
      return reached;
    }
    return hit;
  }

  /// The first group is a capsule: its axis is a tighter bound than its ball.
  HWY_NOINLINE M find_capsule_hits(const GroupRow& first, const GroupRow& second) const {
    const CapsuleRow& capsule = robot_.capsules[first.begin];
    const Segment axis = posed(capsule, pose_);
    const auto reach = sum(capsule.radius, margin_);
    if (second.is_capsule) {
      const CapsuleRow& other = robot_.capsules[second.begin];
      const V distance2 = segment_segment(axis, axis_of(other));
      const M hit = hn::Lt(distance2, lanes_of(squared(sum(other.radius, reach))));
      if constexpr (Margins::kAreLinksDirected)
        return keep_reached(axis, axis_of(other), capsule.radius + other.radius, hit);
      return hit;
    }
    const V from_ball2 = point_segment(splat(second.ball.center), axis);
    if (!is_any_open(from_ball2, second.ball.radius + capsule.radius)) return no_hit();
    M hit = no_hit();
    for (int i = 0; i < kGroupSize; ++i) {
      const Ball& ball = robot_.spheres[second.begin + i];
      const V distance2 = point_segment(splat(ball.center), axis);
      M found = hn::Lt(distance2, lanes_of(squared(sum(ball.radius, reach))));
      if constexpr (Margins::kAreLinksDirected)
        found =
            keep_reached(axis, point_at(splat(ball.center)), capsule.radius + ball.radius, found);
      hit = hn::Or(hit, found);
    }
    return hit;
  }

  const RobotTables& robot_;
  const BodyPairRow& pair_;
  const BodyRow& second_;
  Pose pose_;                    ///< of the first body in the frame of the second
  const Pose* frame_ = nullptr;  ///< of the second body
  Margin margin_;
  const Margins& margins_;
  Verdict<kIsMotion>& verdict_;
};

}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#endif  // MNEME_COLLISION_PAIR_CHECKER_INL_H_
