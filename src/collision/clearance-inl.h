// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Signed distances of points (one per lane) from an obstacle, negative inside, with the direction
// that leads away from it.
#if defined(MNEME_COLLISION_CLEARANCE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MNEME_COLLISION_CLEARANCE_INL_H_
#undef MNEME_COLLISION_CLEARANCE_INL_H_
#else
#define MNEME_COLLISION_CLEARANCE_INL_H_
#endif

#include "collision/distance-inl.h"
#include "collision/tables.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {

/// From a point; the direction is that of `apart`, which leads from there.
HWY_INLINE V clearance_of_core(const V3& apart, V3& normal) {
  const V distance = hn::Sqrt(hn::Max(squared_norm(apart), splat(1e-18f)));
  normal = hn::Div(splat(1.0f), distance) * apart;
  return distance;
}

/// In the coordinates of a box around the origin.
HWY_INLINE V clearance_of_box(const V3& p, const V3& h, V3& normal) {
  const V3 beyond = excess(p, h);
  const V x = hn::Sub(hn::Abs(p.x), h.x), y = hn::Sub(hn::Abs(p.y), h.y),
          z = hn::Sub(hn::Abs(p.z), h.z);
  const V inside = hn::Max(hn::Max(x, y), z);
  const M is_inside = hn::Le(inside, hn::Zero(Tag()));
  const auto towards = [](M is_face, V coordinate) {
    return hn::IfThenElseZero(is_face, hn::CopySign(splat(1.0f), coordinate));
  };
  const M is_x = hn::Ge(x, inside), is_y = hn::AndNot(is_x, hn::Ge(y, inside));
  const M is_z = hn::Not(hn::Or(is_x, is_y));
  V3 outwards;
  const V outside = clearance_of_core(beyond, outwards);
  normal = {hn::IfThenElse(is_inside, towards(is_x, p.x), outwards.x),
            hn::IfThenElse(is_inside, towards(is_y, p.y), outwards.y),
            hn::IfThenElse(is_inside, towards(is_z, p.z), outwards.z)};
  return hn::IfThenElse(is_inside, inside, outside);
}

/// In the coordinates of a cylinder around the origin, along z.
HWY_INLINE V clearance_of_cylinder(const V3& p, V radius, V half_length, V3& normal) {
  const V zero = hn::Zero(Tag());
  const V r = hn::Sqrt(hn::Max(hn::MulAdd(p.x, p.x, hn::Mul(p.y, p.y)), splat(1e-18f)));
  const V side = hn::Sub(r, radius), end = hn::Sub(hn::Abs(p.z), half_length);
  const V inside = hn::Max(side, end);
  const M is_inside = hn::Le(inside, zero);
  const V beyond_side = hn::Max(side, zero), beyond_end = hn::Max(end, zero);
  const V outside = hn::Sqrt(hn::Max(
      hn::MulAdd(beyond_side, beyond_side, hn::Mul(beyond_end, beyond_end)), splat(1e-18f)));
  const V is_side = hn::IfThenElseZero(hn::Ge(side, end), splat(1.0f));
  const V along_r = hn::Div(hn::IfThenElse(is_inside, is_side, hn::Div(beyond_side, outside)), r);
  const V along_z =
      hn::IfThenElse(is_inside, hn::Sub(splat(1.0f), is_side), hn::Div(beyond_end, outside));
  normal = {hn::Mul(along_r, p.x), hn::Mul(along_r, p.y), hn::CopySign(along_z, p.z)};
  return hn::IfThenElse(is_inside, inside, outside);
}

/// The inverse of rotate().
HWY_INLINE V3 rotate_back(const float* r, const V3& v) {
  return {hn::MulAdd(splat(r[0]), v.x, hn::MulAdd(splat(r[3]), v.y, hn::Mul(splat(r[6]), v.z))),
          hn::MulAdd(splat(r[1]), v.x, hn::MulAdd(splat(r[4]), v.y, hn::Mul(splat(r[7]), v.z))),
          hn::MulAdd(splat(r[2]), v.x, hn::MulAdd(splat(r[5]), v.y, hn::Mul(splat(r[8]), v.z)))};
}

/// Distance of `p` from the obstacle's surface; `normal` is a unit vector, but 0 at the centre of a
/// sphere and on the axis of a capsule or cylinder.
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
    case ObstacleKind::crowd:
      break;
  }
  const V3 to_p = p - splat(row.center), along = splat(row.along);
  const V t = clamp01(hn::Mul(dot(to_p, along), splat(row.inverse_length2)));
  return hn::Sub(clearance_of_core(mul_add(hn::Neg(t), along, to_p), normal), splat(row.rounding));
}

}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#endif  // MNEME_COLLISION_CLEARANCE_INL_H_
