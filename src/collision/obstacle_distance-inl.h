// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// One class per kind of obstacle: squared distances from a robot's points and segments, one per
// lane, to its core.
#if defined(MNEME_COLLISION_OBSTACLE_DISTANCE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MNEME_COLLISION_OBSTACLE_DISTANCE_INL_H_
#undef MNEME_COLLISION_OBSTACLE_DISTANCE_INL_H_
#else
#define MNEME_COLLISION_OBSTACLE_DISTANCE_INL_H_
#endif

#include "collision/pair_distance-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {

struct ToSphere {
  const ObstacleRow& row;
  HWY_INLINE V operator()(const V3& p) const { return squared_norm(p - splat(row.center)); }
  HWY_INLINE V operator()(const Segment& s) const { return point_segment(splat(row.center), s); }
};

struct ToAlignedBox {
  const ObstacleRow& row;
  HWY_INLINE V operator()(const V3& p) const {
    return point_box(p - splat(row.center), splat(row.half_extents));
  }
  HWY_INLINE V operator()(const Segment& s) const {
    return segment_box(s.a - splat(row.center), s.u, splat(row.half_extents));
  }
};

struct ToBox {
  const ObstacleRow& row;
  HWY_INLINE V operator()(const V3& p) const {
    return point_box(into_frame(row, p), splat(row.half_extents));
  }
  HWY_INLINE V operator()(const Segment& s) const {
    return segment_box(into_frame(row, s.a), rotate(row.rotation, s.u), splat(row.half_extents));
  }
};

struct ToUprightCylinder {
  const ObstacleRow& row;
  HWY_INLINE V operator()(const V3& p) const {
    return point_cylinder(p - splat(row.center), splat(row.half_extents[0]),
                          splat(row.half_extents[2]));
  }
  HWY_INLINE V operator()(const Segment& s) const {
    return segment_cylinder(s.a - splat(row.center), s.u,
                            {splat(row.half_extents[0]), splat(row.half_extents[2])});
  }
};

struct ToCylinder {
  const ObstacleRow& row;
  HWY_INLINE V operator()(const V3& p) const {
    return point_cylinder(into_frame(row, p), splat(row.half_extents[0]),
                          splat(row.half_extents[2]));
  }
  HWY_INLINE V operator()(const Segment& s) const {
    return segment_cylinder(into_frame(row, s.a), rotate(row.rotation, s.u),
                            {splat(row.half_extents[0]), splat(row.half_extents[2])});
  }
};

struct ToCapsule {
  Segment axis;
  HWY_INLINE explicit ToCapsule(const ObstacleRow& row)
      : axis{splat(row.center), splat(row.along), splat(row.inverse_length2)} {}
  HWY_INLINE V operator()(const V3& p) const { return point_segment(p, axis); }
  HWY_INLINE V operator()(const Segment& s) const { return segment_segment(s, axis); }
};

/// Calls `visit` with the distance to the obstacle's core.
template <class Visit>
HWY_INLINE auto with_distance(const ObstacleRow& row, const Visit& visit) {
  switch (row.kind) {
    case ObstacleKind::aligned_box:
      return visit(ToAlignedBox{row});
    case ObstacleKind::box:
      return visit(ToBox{row});
    case ObstacleKind::upright_cylinder:
      return visit(ToUprightCylinder{row});
    case ObstacleKind::cylinder:
      return visit(ToCylinder{row});
    case ObstacleKind::capsule:
      return visit(ToCapsule(row));
    case ObstacleKind::sphere:
      break;
  }
  return visit(ToSphere{row});
}

}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#endif  // MNEME_COLLISION_OBSTACLE_DISTANCE_INL_H_
