// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Contacts of a robot with a scene and itself, one configuration per lane.
//
// Tests against obstacles, from coarse to fine: the box around a body in all lanes against kLanes
// obstacles at a time, then bounding balls lane by lane, then group by group. Only a group whose
// ball hits has its shapes posed. Bodies are checked against each other by their balls first; the
// rest is PairChecker's. Obstacles near only to lanes already in collision are skipped: most random
// configurations are in collision, each with something else.
#if defined(MNEME_COLLISION_STATE_CHECKER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MNEME_COLLISION_STATE_CHECKER_INL_H_
#undef MNEME_COLLISION_STATE_CHECKER_INL_H_
#else
#define MNEME_COLLISION_STATE_CHECKER_INL_H_
#endif

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstdint>
#include <type_traits>

#include "collision/collision_kernels.h"
#include "collision/compound-inl.h"
#include "tables/distance-inl.h"
#include "tables/separation_table-inl.h"
#include "collision/kinematics-inl.h"
#include "collision/margins-inl.h"
#include "collision/pair_checker-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {

/// Number of bodies that are collected by coarse tests before the finer tests run. More would delay
/// contacts of the tips; fewer would leave vector units idle.
constexpr int kLinkBatch = 4;
/// Number of pairs that are collected by the coarse test before the finer one runs.
constexpr int kListSize = 64;

template <bool kIsMotion, class Margins = EvenMargins>
class StateChecker {
 public:
  HWY_INLINE StateChecker(const RobotTables& robot, const SceneTables& scene,
                          const Margins& margins, CheckCounters& counters)
      : robot_(robot), scene_(scene), margins_(margins), counters_(counters) {
    assert(robot.frames.size() <= kMaxFrames && robot.bodies.size() <= kMaxBodies);
    assert(scene.lower[0].size() % kObstacleBlock == 0);
    set_rotation(scene.rotation, poses_[0]);
    for (size_t i = robot.moving_count; i < robot.bodies.size(); ++i) {
      centers_[i] = transform_point(poses_[0], robot.bodies[i].ball.center);
    }
  }

  /// Returns true as soon as the verdict is final.
  HWY_INLINE bool check(const V* q, Verdict<kIsMotion>& verdict) {
    q_ = q;
    pose_frames(robot_, q, poses_);
    counters_.work += kLanes * kStateWork;
    margins_.follow(poses_);
    for (int begin = 0; begin < robot_.moving_count; begin += kLinkBatch) {
      const int end = std::min(begin + kLinkBatch, robot_.moving_count);
      for (int i = begin; i < end; ++i) {
        const BodyRow& body = robot_.bodies[i];
        centers_[i] = transform_point(poses_[body.frame], body.ball.center);
      }
      if (hits_scene(begin, end, verdict)) return true;
    }
    return hits_self(verdict);
  }

 private:
  HWY_INLINE bool hits_scene(int first, int last, Verdict<kIsMotion>& verdict) const {
    int bodies[kLinkBatch];
    Extent extents[kLinkBatch];
    int body_count = 0;
    for (int i = first; i < last; ++i) {
      const float margin = margins_.widest_of_body(i);
      if (!margins_.moves_body(i) || !scene_.is_reached(i, margin)) continue;
      extents[body_count].set(centers_[i], robot_.bodies[i].ball.radius + margin);
      bodies[body_count++] = i;
    }
    counters_.work += scan_work(scene_, body_count);
    for (size_t begin = 0; body_count > 0 && begin < scene_.lower[0].size(); begin += kLanes) {
      int near[kLinkBatch];
      unsigned overlaps[kLinkBatch];
      int count = 0;
      for (int i = 0; i < body_count; ++i) {
        near[count] = bodies[i];
        overlaps[count] = find_overlaps(scene_, extents[i], begin);
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
    counters_.work += kLanes * kTestWork * static_cast<std::uint64_t>(std::popcount(bits));
    for (; bits != 0; bits &= bits - 1) {
      const size_t i = begin + static_cast<size_t>(__builtin_ctz(bits));
      near[count] = &scene_.obstacles[i];
      count += is_near(i, centers_[index], reach, verdict);
    }
    const Pose& pose = poses_[body.frame];
    const bool is_one = body.cluster_end - body.cluster_begin == 1;
    for (int c = body.cluster_begin; count > 0 && c < body.cluster_end; ++c) {
      const ObstacleRow* listed[kLanes];
      const ObstacleRow* const* closer = is_one ? near : listed;
      const int kept = is_one ? count : list_near(c, pose, margin, near, count, listed, verdict);
      for (int g = robot_.clusters[c].begin; kept > 0 && g < robot_.clusters[c].end; ++g) {
        const ObstacleRow* checked[kLanes];
        const bool may_touch = !scene_.may_touch.empty();
        const int left = may_touch ? list_forbidden(g, closer, kept, checked) : kept;
        const ObstacleRow* const* rows = may_touch ? checked : closer;
        if (hits_obstacles(index, robot_.groups[g], margin, rows, left, verdict)) return true;
      }
    }
    return false;
  }

  /// True if balls reach the bounds of an obstacle; for a compound shape, if its grid does not
  /// exclude a contact.
  template <class Reach>
  HWY_INLINE bool is_near(size_t obstacle, const V3& center, Reach reach,
                          const Verdict<kIsMotion>& verdict) const {
    const V distance2 = distance2_to_bounds(scene_, center, obstacle);
    if (!verdict.is_any_open(is_below(distance2, squared(reach)))) return false;
    const ObstacleRow& row = scene_.obstacles[obstacle];
    if (row.kind != ObstacleKind::compound) return true;
    const CompoundRow& compound = scene_.compounds[row.compound];
    const V3 p = into_compound(compound, center);
    return (find_near(*compound.voxels, p, lanes_of(sum(row.rounding, reach))) &
            ~bits_of(verdict.hit)) != 0;
  }

  /// Lists those of `count` obstacles that are near a cluster.
  template <class Margin>
  HWY_INLINE int list_near(int cluster, const Pose& pose, Margin margin,
                           const ObstacleRow* const* from, int count, const ObstacleRow** near,
                           const Verdict<kIsMotion>& verdict) const {
    const V3 center = transform_point(pose, robot_.clusters[cluster].ball.center);
    const auto reach = sum(robot_.clusters[cluster].ball.radius, margin);
    int kept = 0;
    for (int i = 0; i < count; ++i) {
      near[kept] = from[i];
      const auto obstacle = static_cast<size_t>(from[i] - scene_.obstacles.data());
      kept += is_near(obstacle, center, reach, verdict);
    }
    return kept;
  }

  /// Lists those of `count` obstacles that a group may not touch.
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
  HWY_INLINE bool hits_obstacles([[maybe_unused]] int index, const GroupRow& group, Margin margin,
                                 const ObstacleRow* const* near, int count,
                                 Verdict<kIsMotion>& verdict) const {
    const Pose& pose = poses_[robot_.bodies[index].frame];
    if (group.is_capsule) {
      const CapsuleRow& capsule = robot_.capsules[group.begin];
      return hits_obstacles(index, capsule, posed(capsule, pose), margin, near, count, verdict);
    }
    const V3 center = transform_point(pose, group.ball.center);
    PosedSpheres spheres;
    bool is_posed = false;
    for (int i = 0; i < count; ++i) {
      const auto extra = sum(near[i]->rounding, margin);
      if (near[i]->kind == ObstacleKind::compound) {
        if (verdict.add(find_compound_hits(*near[i], group, pose, extra, verdict.hit))) return true;
        continue;
      }
      const auto reach2 = squared(sum(group.ball.radius, extra));
      M hit = with_distance(*near[i], [&](const auto& distance2) {
        if (!verdict.is_any_open(is_below(distance2(center), reach2))) return no_hit();
        if (!is_posed) spheres = posed(robot_, group, pose);
        is_posed = true;
        return find_hits(robot_, group, spheres, extra, distance2);
      });
      if constexpr (Margins::kIsDirected) hit = keep_reached(index, group, spheres, *near[i], hit);
      if (verdict.add(hit)) return true;
    }
    return false;
  }

  /// Returns those lanes of `hit` in which a sphere may move up to the obstacle: a convex solid
  /// does not reach beyond the plane through its nearest point.
  HWY_NOINLINE M keep_reached(int index, const GroupRow& group, const PosedSpheres& spheres,
                              const ObstacleRow& obstacle, M hit) const {
    M reached = no_hit();
    if (hn::AllFalse(Tag(), hit)) return reached;
    for (int i = 0; i < kGroupSize; ++i) {
      const V3& center = spheres.centers[i];
      V3 normal;
      const V clearance = clearance_of(obstacle, center, normal);
      const V gap = hn::Sub(clearance, splat(robot_.spheres[group.begin + i].radius));
      reached = hn::Or(reached, margins_.find_reached(index, center, normal, gap, hit));
    }
    return reached;
  }

  /// The same for a capsule, whose two ends must stay on this side of the plane.
  HWY_NOINLINE M keep_reached(int index, const CapsuleRow& capsule, const Segment& axis,
                              const ObstacleRow& obstacle, M hit) const {
    if (hn::AllFalse(Tag(), hit)) return hit;
    const V t = nearest_on(axis, obstacle);
    const V3 nearest = mul_add(t, axis.u, axis.a);
    V3 normal;
    const V gap = hn::Sub(clearance_of(obstacle, nearest, normal), splat(capsule.radius));
    M reached = no_hit();
    for (const V3& end : {axis.a, axis.a + axis.u}) {
      const V farther = hn::Add(gap, dot(normal, end - nearest));
      reached = hn::Or(reached, margins_.find_reached(index, end, normal, farther, hit));
    }
    return reached;
  }

  template <class Margin>
  HWY_NOINLINE bool hits_obstacles([[maybe_unused]] int index, const CapsuleRow& capsule,
                                   const Segment& axis, Margin margin,
                                   const ObstacleRow* const* near, int count,
                                   Verdict<kIsMotion>& verdict) const {
    for (int i = 0; i < count; ++i) {
      const auto obstacle = static_cast<size_t>(near[i] - scene_.obstacles.data());
      // Bounds include the rounding.
      const auto thickness2 = squared(sum(capsule.radius, margin));
      const V from_bounds2 = distance2_to_bounds(scene_, axis, obstacle);
      if (!verdict.is_any_open(is_below(from_bounds2, thickness2))) continue;
      const auto reach = sum(capsule.radius + near[i]->rounding, margin);
      if (near[i]->kind == ObstacleKind::compound) {
        if (verdict.add(find_compound_hits(*near[i], capsule, axis, reach, verdict.hit)))
          return true;
        continue;
      }
      M hit = with_distance(*near[i], [&](const auto& distance2) {
        return hn::Lt(distance2(axis), lanes_of(squared(reach)));
      });
      if constexpr (Margins::kIsDirected) hit = keep_reached(index, capsule, axis, *near[i], hit);
      if (verdict.add(hit)) return true;
    }
    return false;
  }

  /// Lanes, not `known` to be hit, in which a sphere of the group comes closer than `extra` to a
  /// part of the compound shape.
  template <class Margin>
  HWY_NOINLINE M find_compound_hits(const ObstacleRow& row, const GroupRow& group, const Pose& pose,
                                    Margin extra, M known) const {
    const CompoundRow& compound = scene_.compounds[row.compound];
    const V3 center = into_compound(compound, transform_point(pose, group.ball.center));
    const V around = lanes_of(sum(group.ball.radius, extra));
    unsigned open = find_near(*compound.voxels, center, around) & ~bits_of(known);
    unsigned hits = 0;
    for (int i = group.begin; open != 0 && i < group.begin + kGroupSize; ++i) {
      const Ball& ball = robot_.spheres[i];
      const V3 p = into_compound(compound, transform_point(pose, ball.center));
      const V reach = lanes_of(sum(ball.radius, extra));
      const unsigned found = find_ball_touches<kIsMotion>(compound, p, reach, open);
      hits |= found;
      open &= ~found;
      if (kIsMotion && found != 0) break;
    }
    return mask_of(hits);
  }

  template <class Margin>
  HWY_NOINLINE M find_compound_hits(const ObstacleRow& row, const CapsuleRow& capsule,
                                    const Segment& axis, Margin reach, M known) const {
    const CompoundRow& compound = scene_.compounds[row.compound];
    const V3 a = into_compound(compound, axis.a), u = rotate(compound.rotation, axis.u);
    return mask_of(find_capsule_touches<kIsMotion>(compound, a, u, capsule.inverse_length2,
                                                   lanes_of(reach), ~bits_of(known)));
  }

  HWY_INLINE bool hits_self(Verdict<kIsMotion>& verdict) const {
    const int pair_count = static_cast<int>(robot_.body_pairs.size());
    for (int begin = 0; begin < pair_count; begin += kListSize) {
      const int end = std::min(begin + kListSize, pair_count);
      int near[kListSize];
      int count = 0;
      // Pairs are in the order of their first bodies, whose centers stay in registers.
      int first = robot_.body_pairs[begin].first;
      V3 center = centers_[first];
      for (int i = begin; i < end; ++i) {
        const BodyPairRow& pair = robot_.body_pairs[i];
        if (!margins_.moves_pair(i)) continue;
        near[count] = i;
        if (pair.first != first) {
          first = pair.first;
          center = centers_[first];
        }
        const V apart2 = squared_norm(center - centers_[pair.second]);
        count += verdict.is_any_open(is_below(apart2, margins_.reach2(pair, i)));
      }
      for (int i = 0; i < count; ++i) {
        if (hits_body(near[i], verdict)) return true;
      }
    }
    return false;
  }

  HWY_NOINLINE bool hits_body(int index, Verdict<kIsMotion>& verdict) const {
    const BodyPairRow& pair = robot_.body_pairs[index];
    if (pair.separation_table >= 0) {
      const SeparationTable& table = (*robot_.separation_tables)[pair.separation_table];
      if (!verdict.is_any_open(hn::Lt(rings_at(table, q_), margins_.needed_rings(table)))) {
        return false;
      }
    }
    const auto margin = margins_.of_pair(index, centers_);
    const Pose& first = poses_[robot_.bodies[pair.first].frame];
    const Pose& second = poses_[robot_.bodies[pair.second].frame];
    using Margin = std::remove_const_t<decltype(margin)>;
    return PairChecker<kIsMotion, Margin, Margins>(robot_, pair, margin, margins_, verdict)
        .check(first, second, centers_);
  }

  const RobotTables& robot_;
  const SceneTables& scene_;
  const Margins& margins_;
  const V* q_ = nullptr;  ///< the state that is checked
  CheckCounters& counters_;
  Pose poses_[kMaxFrames + 1];
  V3 centers_[kMaxBodies];
};

}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#endif  // MNEME_COLLISION_STATE_CHECKER_INL_H_
