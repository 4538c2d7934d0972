// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// What a robot touches, one configuration per lane.
//
// What is far apart costs little: bodies are held against obstacles 16 at a time by the box that a
// body sweeps in all lanes, then by their bounding balls lane by lane, then group by group; only a
// group whose ball hits has its shapes posed. Bodies are held against each other by their balls,
// then each one's ball against the other's box, then cluster by cluster.
#if defined(MNEME_COLLISION_STATE_CHECKER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MNEME_COLLISION_STATE_CHECKER_INL_H_
#undef MNEME_COLLISION_STATE_CHECKER_INL_H_
#else
#define MNEME_COLLISION_STATE_CHECKER_INL_H_
#endif

#include <algorithm>
#include <cstdint>

#include "collision/collision_kernels.h"
#include "collision/crowd-inl.h"
#include "collision/distance-inl.h"
#include "collision/forward_kinematics-inl.h"
#include "collision/margins-inl.h"
#include "collision/scene_boxes-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {

/// What is hit so far. With `kIsMotion`, one hit in any lane settles the question; otherwise all
/// lanes must be hit before the rest can be skipped.
template <bool kIsMotion>
struct Verdict {
  // A default member initialiser would be compiled for the baseline instruction set.
  HWY_INLINE Verdict() : hit(hn::MaskFromVec(hn::Zero(Tag()))) {}

  M hit;

  HWY_INLINE bool add(M mask) {
    hit = hn::Or(hit, mask);
    return kIsMotion ? !hn::AllFalse(Tag(), hit) : hn::AllTrue(Tag(), hit);
  }
};

/// So many bodies go through the coarse tests before the finer ones: more would put off contacts of
/// the tips, fewer would wait for each other.
constexpr int kBatch = 4;
/// What passed a coarse test is listed before the finer one.
constexpr int kListSize = 64;
/// Clusters of a body that are held against those of another together.
constexpr int kMostRuns = 32;

/// The spheres of a group, one pose per lane.
struct PosedSpheres {
  V3 centers[kGroupSize];
};

template <bool kIsMotion, class Margins = EvenMargins>
class StateChecker {
 public:
  HWY_INLINE StateChecker(const RobotTables& robot, const SceneTables& scene,
                          const Margins& margins)
      : robot_(robot), scene_(scene), margins_(margins) {
    poses_[0] = splat_rotation(scene.rotation);
    for (size_t i = robot.moving_count; i < robot.bodies.size(); ++i) {
      centers_[i] = transform_point(poses_[0], robot.bodies[i].ball.center);
    }
  }

  /// True as soon as the verdict is settled.
  HWY_INLINE bool check(const V* q, Verdict<kIsMotion>& verdict) {
    pose_frames(robot_, q, poses_);
    margins_.follow(poses_);
    for (int begin = 0; begin < robot_.moving_count; begin += kBatch) {
      const int end = std::min(begin + kBatch, robot_.moving_count);
      for (int i = begin; i < end; ++i) {
        const BodyRow& body = robot_.bodies[i];
        centers_[i] = transform_point(poses_[body.frame], body.ball.center);
        extents_[i].set(centers_[i]);
      }
      if (hits_scene(begin, end, verdict)) return true;
    }
    return hits_self(verdict);
  }

 private:
  HWY_INLINE bool hits_scene(int first, int last, Verdict<kIsMotion>& verdict) const {
    for (size_t begin = 0; begin < scene_.lower[0].size(); begin += kLanes) {
      int near[kBatch];
      unsigned overlaps[kBatch];
      int count = 0;
      for (int i = first; i < last; ++i) {
        near[count] = i;
        if (!margins_.moves_body(i)) continue;
        const float reach = robot_.bodies[i].ball.radius + margins_.widest_of_body(i);
        overlaps[count] = find_overlaps(scene_, extents_[i], reach, begin);
        count += overlaps[count] != 0;
      }
      for (int i = 0; i < count; ++i) {
        if (hits_obstacles(near[i], begin, overlaps[i], verdict)) return true;
      }
    }
    return false;
  }

  HWY_NOINLINE bool hits_obstacles(int index, size_t begin, unsigned bits,
                                   Verdict<kIsMotion>& verdict) const {
    const BodyRow& body = robot_.bodies[index];
    const auto margin = margins_.of_body(index, centers_[index]);
    const auto reach = sum(body.ball.radius, margin);
    const ObstacleRow* near[kLanes];
    int count = 0;
    for (; bits != 0; bits &= bits - 1) {
      const size_t i = begin + static_cast<size_t>(__builtin_ctz(bits));
      near[count] = &scene_.obstacles[i];
      count += is_near(i, centers_[index], reach);
    }
    const Pose& pose = poses_[body.frame];
    const bool is_one = body.cluster_end - body.cluster_begin == 1;
    for (int c = body.cluster_begin; count > 0 && c < body.cluster_end; ++c) {
      const ObstacleRow* listed[kLanes];
      const ObstacleRow* const* closer = is_one ? near : listed;
      const int kept = is_one ? count : list_near(c, pose, margin, near, count, listed);
      for (int g = robot_.clusters[c].begin; kept > 0 && g < robot_.clusters[c].end; ++g) {
        const ObstacleRow* checked[kLanes];
        const bool may_touch = !scene_.may_touch.empty();
        const int left = may_touch ? list_forbidden(g, closer, kept, checked) : kept;
        const ObstacleRow* const* rows = may_touch ? checked : closer;
        if (hits_obstacles(robot_.groups[g], pose, margin, rows, left, verdict)) return true;
      }
    }
    return false;
  }

  /// Whether balls reach the bounds of an obstacle, or, as far as its grid knows, a part of a
  /// crowd.
  template <class Reach>
  HWY_INLINE bool is_near(size_t obstacle, const V3& center, Reach reach) const {
    if (!is_any_below(distance2_to_bounds(scene_, center, obstacle), squared(reach))) return false;
    const ObstacleRow& row = scene_.obstacles[obstacle];
    if (row.kind != ObstacleKind::crowd) return true;
    const CrowdRow& crowd = scene_.crowds[row.crowd];
    return find_near(*crowd.cells, into_crowd(crowd, center), lanes_of(sum(row.rounding, reach))) !=
           0;
  }

  /// The obstacles of `count` that are near a cluster.
  template <class Margin>
  HWY_INLINE int list_near(int cluster, const Pose& pose, Margin margin,
                           const ObstacleRow* const* from, int count,
                           const ObstacleRow** near) const {
    const V3 center = transform_point(pose, robot_.clusters[cluster].ball.center);
    const auto reach = sum(robot_.clusters[cluster].ball.radius, margin);
    int kept = 0;
    for (int i = 0; i < count; ++i) {
      near[kept] = from[i];
      kept += is_near(static_cast<size_t>(from[i] - scene_.obstacles.data()), center, reach);
    }
    return kept;
  }

  /// What a group may not touch of `count` obstacles.
  HWY_NOINLINE int list_forbidden(int group, const ObstacleRow* const* near, int count,
                                  const ObstacleRow** forbidden) const {
    int kept = 0;
    for (int i = 0; i < count; ++i) {
      forbidden[kept] = near[i];
      kept += !scene_.may_group_touch(group, near[i] - scene_.obstacles.data());
    }
    return kept;
  }

  template <class Margin>
  HWY_INLINE bool hits_obstacles(const GroupRow& group, const Pose& pose, Margin margin,
                                 const ObstacleRow* const* near, int count,
                                 Verdict<kIsMotion>& verdict) const {
    if (group.is_capsule) {
      const CapsuleRow& capsule = robot_.capsules[group.begin];
      return hits_obstacles(capsule, posed(capsule, pose), margin, near, count, verdict);
    }
    const V3 center = transform_point(pose, group.ball.center);
    PosedSpheres spheres;
    bool is_posed = false;
    for (int i = 0; i < count; ++i) {
      const auto extra = sum(near[i]->rounding, margin);
      if (near[i]->kind == ObstacleKind::crowd) {
        if (verdict.add(find_crowd_hits(*near[i], group, pose, extra, verdict.hit))) return true;
        continue;
      }
      const auto reach2 = squared(sum(group.ball.radius, extra));
      const M hit = with_distance(*near[i], [&](const auto& distance2) {
        if (!is_any_below(distance2(center), reach2)) return hn::MaskFromVec(hn::Zero(Tag()));
        if (!is_posed) spheres = posed(group, pose);
        is_posed = true;
        return find_hits(group, spheres, extra, distance2);
      });
      if (verdict.add(hit)) return true;
    }
    return false;
  }

  template <class Margin>
  HWY_NOINLINE bool hits_obstacles(const CapsuleRow& capsule, const Segment& axis, Margin margin,
                                   const ObstacleRow* const* near, int count,
                                   Verdict<kIsMotion>& verdict) const {
    for (int i = 0; i < count; ++i) {
      const auto reach = sum(capsule.radius + near[i]->rounding, margin);
      if (near[i]->kind == ObstacleKind::crowd) {
        if (verdict.add(find_crowd_hits(*near[i], capsule, axis, reach, verdict.hit))) return true;
        continue;
      }
      const M hit = with_distance(*near[i], [&](const auto& distance2) {
        return hn::Lt(distance2(axis), lanes_of(squared(reach)));
      });
      if (verdict.add(hit)) return true;
    }
    return false;
  }

  /// Where a sphere of the group comes closer than `extra` to a part of the crowd, but for lanes
  /// that are hit already.
  template <class Margin>
  HWY_NOINLINE M find_crowd_hits(const ObstacleRow& row, const GroupRow& group, const Pose& pose,
                                 Margin extra, M known) const {
    const CrowdRow& crowd = scene_.crowds[row.crowd];
    const V3 center = into_crowd(crowd, transform_point(pose, group.ball.center));
    const V around = lanes_of(sum(group.ball.radius, extra));
    unsigned open = find_near(*crowd.cells, center, around) & ~bits_of(known);
    unsigned hits = 0;
    for (int i = group.begin; open != 0 && i < group.begin + kGroupSize; ++i) {
      const Ball& ball = robot_.spheres[i];
      const V3 p = into_crowd(crowd, transform_point(pose, ball.center));
      const V reach = lanes_of(sum(ball.radius, extra));
      const unsigned found = find_ball_touches<kIsMotion>(crowd, p, reach, open);
      hits |= found;
      open &= ~found;
      if (kIsMotion && found != 0) break;
    }
    return mask_of(hits);
  }

  template <class Margin>
  HWY_NOINLINE M find_crowd_hits(const ObstacleRow& row, const CapsuleRow& capsule,
                                 const Segment& axis, Margin reach, M known) const {
    const CrowdRow& crowd = scene_.crowds[row.crowd];
    const V3 a = into_crowd(crowd, axis.a), u = rotate(crowd.rotation, axis.u);
    return mask_of(find_capsule_touches<kIsMotion>(crowd, a, u, capsule.inverse_length2,
                                                   lanes_of(reach), ~bits_of(known)));
  }

  HWY_INLINE PosedSpheres posed(const GroupRow& group, const Pose& pose) const {
    PosedSpheres result;
    for (int i = 0; i < kGroupSize; ++i) {
      result.centers[i] = transform_point(pose, robot_.spheres[group.begin + i].center);
    }
    return result;
  }

  HWY_INLINE Segment posed(const CapsuleRow& capsule, const Pose& pose) const {
    const V zero = hn::Zero(Tag());
    return {add_sparse(pose, capsule.a, pose.origin),
            add_sparse(pose, capsule.along, {zero, zero, zero}), splat(capsule.inverse_length2)};
  }

  /// Where a sphere of the group comes closer than `extra` to something, given squared distances.
  template <class Margin, class Distance2>
  HWY_INLINE M find_hits(const GroupRow& group, const PosedSpheres& spheres, Margin extra,
                         const Distance2& distance2) const {
    M hit = hn::MaskFromVec(hn::Zero(Tag()));
    for (int i = 0; i < kGroupSize; ++i) {
      const V reach = lanes_of(sum(robot_.spheres[group.begin + i].radius, extra));
      hit = hn::Or(hit, hn::Lt(distance2(spheres.centers[i]), hn::Mul(reach, reach)));
    }
    return hit;
  }

  HWY_INLINE bool hits_self(Verdict<kIsMotion>& verdict) const {
    const int pair_count = static_cast<int>(robot_.body_pairs.size());
    for (int begin = 0; begin < pair_count; begin += kListSize) {
      const int end = std::min(begin + kListSize, pair_count);
      int near[kListSize];
      int count = 0;
      for (int i = begin; i < end; ++i) {
        const BodyPairRow& pair = robot_.body_pairs[i];
        if (!margins_.moves_pair(i)) continue;
        near[count] = i;
        count += is_any_below(squared_norm(centers_[pair.first] - centers_[pair.second]),
                              margins_.reach2(pair, i));
      }
      for (int i = 0; i < count; ++i) {
        if (hits_body(near[i], verdict)) return true;
      }
    }
    return false;
  }

  HWY_NOINLINE bool hits_body(int index, Verdict<kIsMotion>& verdict) const {
    const BodyPairRow& pair = robot_.body_pairs[index];
    const auto margin = margins_.of_pair(index, centers_);
    const BodyRow &first = robot_.bodies[pair.first], &other = robot_.bodies[pair.second];
    if (!reaches_box(first.ball.radius, centers_[pair.first], other, margin) ||
        !reaches_box(other.ball.radius, centers_[pair.second], first, margin)) {
      return false;
    }
    return hits_runs(pair, margin, verdict);
  }

  /// Whether a ball comes near a body's box in any lane: long bodies fill little of their balls.
  template <class Margin>
  HWY_INLINE bool reaches_box(float radius, const V3& center, const BodyRow& body,
                              Margin margin) const {
    const Pose& pose = poses_[body.frame];
    const V3 from = center - pose.origin;
    const auto beyond = [&](int axis) {
      const V along = dot(from, pose.axes[axis]);
      return hn::Max(
          hn::Max(hn::Sub(splat(body.low[axis]), along), hn::Sub(along, splat(body.high[axis]))),
          hn::Zero(Tag()));
    };
    return is_any_below(squared_norm(V3{beyond(0), beyond(1), beyond(2)}),
                        squared(sum(radius, margin)));
  }

  /// Clusters are held against each other first.
  template <class Margin>
  HWY_NOINLINE bool hits_runs(const BodyPairRow& pair, Margin margin,
                              Verdict<kIsMotion>& verdict) const {
    Run runs[kMostRuns];
    for (int begin = pair.begin; begin < pair.end;) {
      int count = 0;
      while (begin < pair.end && count < kMostRuns) {
        const bool is_near = start_run(pair, begin, margin, runs[count]);
        begin = runs[count].end;
        count += is_near;
      }
      if (count > 0) find_near_clusters(robot_.bodies[pair.second], margin, runs, count);
      for (int i = 0; i < count; ++i) {
        for (int k = runs[i].begin; k < runs[i].end && runs[i].near != 0; ++k) {
          if (hits_groups(pair, k, runs[i].near, margin, verdict)) return true;
        }
      }
    }
    return false;
  }

  /// Pairs of groups, the first of which are of one cluster, and which clusters of the other body
  /// come near that: a bit each (bit_of).
  struct Run {
    int begin, end;
    V3 center;
    float radius;
    std::uint64_t near;
  };
  /// The last of many clusters share a bit.
  static HWY_INLINE std::uint64_t bit_of(int cluster, const BodyRow& body) {
    return std::uint64_t{1} << std::min(cluster - body.cluster_begin, 63);
  }

  /// False if it is far from the pair's second body.
  template <class Margin>
  HWY_INLINE bool start_run(const BodyPairRow& pair, int begin, Margin margin, Run& run) const {
    const int cluster = robot_.groups[robot_.group_pairs[begin].first].cluster;
    run.begin = begin;
    run.end = begin + 1;
    while (run.end < pair.end &&
           robot_.groups[robot_.group_pairs[run.end].first].cluster == cluster) {
      ++run.end;
    }
    const Ball& ball = robot_.clusters[cluster].ball;
    run.center = transform_point(poses_[robot_.bodies[pair.first].frame], ball.center);
    run.radius = ball.radius;
    return reaches_box(ball.radius, run.center, robot_.bodies[pair.second], margin);
  }

  /// Capsules are held against by their axes: their balls say little if they are long.
  template <class Margin>
  HWY_INLINE void find_near_clusters(const BodyRow& body, Margin margin, Run* runs,
                                     int count) const {
    const Pose& pose = poses_[body.frame];
    for (int i = 0; i < count; ++i) runs[i].near = 0;
    for (int c = body.cluster_begin; c < body.cluster_end; ++c) {
      const std::uint64_t bit = bit_of(c, body);
      const ClusterRow& cluster = robot_.clusters[c];
      const auto mark = [&](float radius, const auto& distance2) {
        for (int i = 0; i < count; ++i) {
          const auto reach2 = squared(sum(radius + runs[i].radius, margin));
          runs[i].near |= is_any_below(distance2(runs[i].center), reach2) ? bit : 0;
        }
      };
      const GroupRow& group = robot_.groups[cluster.begin];
      if (group.is_capsule) {
        const CapsuleRow& capsule = robot_.capsules[group.begin];
        const Segment axis = posed(capsule, pose);
        mark(capsule.radius, [&](const V3& p) { return point_segment(p, axis); });
      } else {
        const V3 center = transform_point(pose, cluster.ball.center);
        mark(cluster.ball.radius, [&](const V3& p) { return squared_norm(p - center); });
      }
    }
  }

  /// A row of the pair against those clusters of its second body that are near.
  template <class Margin>
  HWY_INLINE bool hits_groups(const BodyPairRow& bodies, int index, std::uint64_t near,
                              Margin margin, Verdict<kIsMotion>& verdict) const {
    const GroupPairRow& pair = robot_.group_pairs[index];
    const Pose& pose = poses_[robot_.bodies[bodies.first].frame];
    const Pose& other_pose = poses_[robot_.bodies[bodies.second].frame];
    const GroupRow& first = robot_.groups[pair.first];
    const V3 center = transform_point(pose, first.ball.center);
    const auto is_near = [&](const Ball& ball) {
      return is_any_below(squared_norm(transform_point(other_pose, ball.center) - center),
                          squared(sum(ball.radius + first.ball.radius, margin)));
    };
    for (int begin = pair.second_begin; begin < pair.second_end;) {
      const int c = robot_.groups[begin].cluster;
      const ClusterRow& cluster = robot_.clusters[c];
      const int end = std::min(cluster.end, pair.second_end);
      const bool is_far = (near & bit_of(c, robot_.bodies[bodies.second])) == 0;
      if (is_far || (end - begin > 1 && !is_near(cluster.ball))) begin = end;
      for (; begin < end; ++begin) {
        const GroupRow& second = robot_.groups[begin];
        if (!second.is_capsule && !is_near(second.ball)) continue;
        if (verdict.add(find_hits(first, pose, second, other_pose, margin))) return true;
      }
    }
    return false;
  }

  template <class Margin>
  HWY_INLINE M find_hits(const GroupRow& first, const Pose& pose, const GroupRow& second,
                         const Pose& other_pose, Margin margin) const {
    if (first.is_capsule) return find_capsule_hits(first, pose, second, other_pose, margin);
    if (second.is_capsule) return find_capsule_hits(second, other_pose, first, pose, margin);
    return find_sphere_hits(first, pose, second, other_pose, margin);
  }

  template <class Margin>
  HWY_INLINE M find_sphere_hits(const GroupRow& first, const Pose& pose, const GroupRow& second,
                                const Pose& other_pose, Margin margin) const {
    const PosedSpheres spheres = posed(first, pose), others = posed(second, other_pose);
    M hit = hn::MaskFromVec(hn::Zero(Tag()));
    for (int i = 0; i < kGroupSize; ++i) {
      const auto distance2 = [&](const V3& p) { return squared_norm(p - spheres.centers[i]); };
      const auto extra = sum(robot_.spheres[first.begin + i].radius, margin);
      hit = hn::Or(hit, find_hits(second, others, extra, distance2));
    }
    return hit;
  }

  /// The first group is a capsule. Its ball says little if it is long: its axis says more of the
  /// other's ball.
  template <class Margin>
  HWY_NOINLINE M find_capsule_hits(const GroupRow& first, const Pose& pose, const GroupRow& second,
                                   const Pose& other_pose, Margin margin) const {
    const CapsuleRow& capsule = robot_.capsules[first.begin];
    const Segment axis = posed(capsule, pose);
    if (!second.is_capsule) {
      const auto reach = sum(capsule.radius, margin);
      const V3 center = transform_point(other_pose, second.ball.center);
      if (!is_any_below(point_segment(center, axis), squared(sum(second.ball.radius, reach)))) {
        return hn::MaskFromVec(hn::Zero(Tag()));
      }
      return find_hits(second, posed(second, other_pose), reach,
                       [&](const V3& p) { return point_segment(p, axis); });
    }
    const CapsuleRow& other = robot_.capsules[second.begin];
    const V distance2 = segment_segment(axis, posed(other, other_pose));
    return hn::Lt(distance2, lanes_of(squared(sum(capsule.radius + other.radius, margin))));
  }

  const RobotTables& robot_;
  const SceneTables& scene_;
  const Margins& margins_;
  Pose poses_[kMaxFrames + 1];
  V3 centers_[kMaxBodies];
  Extent extents_[kMaxBodies];
};

}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#endif  // MNEME_COLLISION_STATE_CHECKER_INL_H_
