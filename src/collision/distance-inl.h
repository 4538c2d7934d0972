// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Squared distances between a robot's points and segments (one per lane) and an obstacle, 0 inside.
#if defined(MNEME_COLLISION_DISTANCE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MNEME_COLLISION_DISTANCE_INL_H_
#undef MNEME_COLLISION_DISTANCE_INL_H_
#else
#define MNEME_COLLISION_DISTANCE_INL_H_
#endif

#include "tables/tables.h"
#include "geometry/solids-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {

HWY_INLINE V3 into_frame(const ObstacleRow& row, const V3& p) {
  return rotate(row.rotation, p - splat(row.center));
}

// One class per kind of obstacle: squared distances to its core.

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
    case ObstacleKind::compound:  // has no distance of this kind: compound-inl.h
      break;
  }
  return visit(ToSphere{row});
}

/// Distance of `p` from the obstacle's surface, negative inside; `normal` leads away from it: a
/// unit vector, but 0 at the centre of a sphere and on the axis of a capsule or cylinder.
HWY_INLINE V clearance_of(const ObstacleRow& row, const V3& p, V3& normal) {
  const V3 half_extents = splat(row.half_extents);
  switch (row.kind) {
    case ObstacleKind::aligned_box:
      return clearance_of_box(p - splat(row.center), half_extents, normal);
    case ObstacleKind::upright_cylinder:
      return clearance_of_cylinder(p - splat(row.center), half_extents.x, half_extents.z, normal);
    case ObstacleKind::box: {
      const V distance = clearance_of_box(into_frame(row, p), half_extents, normal);
      normal = rotate_back(row.rotation, normal);
      return distance;
    }
    case ObstacleKind::cylinder: {
      const V distance =
          clearance_of_cylinder(into_frame(row, p), half_extents.x, half_extents.z, normal);
      normal = rotate_back(row.rotation, normal);
      return distance;
    }
    case ObstacleKind::sphere:
    case ObstacleKind::capsule:
    case ObstacleKind::compound:
      break;
  }
  const V3 to_p = p - splat(row.center), along = splat(row.along);
  const V t = clamp01(hn::Mul(dot(to_p, along), splat(row.inverse_length2)));
  return hn::Sub(clearance_of_core(mul_add(hn::Neg(t), along, to_p), normal), splat(row.rounding));
}

}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#endif  // MNEME_COLLISION_DISTANCE_INL_H_
