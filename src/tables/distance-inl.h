// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Squared distances from points and segments of the robot, one per lane, to an obstacle; 0 inside.
#if defined(MNEME_TABLES_DISTANCE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MNEME_TABLES_DISTANCE_INL_H_
#undef MNEME_TABLES_DISTANCE_INL_H_
#else
#define MNEME_TABLES_DISTANCE_INL_H_
#endif

#include "tables/tables.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {

/// A segment per lane: a + t u, t in [0, 1].
struct Segment {
  V3 a, u;
  V inverse_length2;  ///< 1 / |u|^2, or 0 for a point
};

HWY_INLINE V safe_inverse(V x) {
  return hn::IfThenZeroElse(hn::Lt(x, splat(1e-30f)), hn::Div(splat(1.0f), x));
}

HWY_INLINE V point_segment(const V3& p, const Segment& s) {
  const V3 w = p - s.a;
  const V t = clamp01(hn::Mul(dot(w, s.u), s.inverse_length2));
  return squared_norm(mul_add(hn::Neg(t), s.u, w));
}

/// Leads from `p` to `q` where they are nearest. Follows Ericson, section 5.1.9, but takes the
/// determinant from the cross product n of the directions: for nearly parallel segments |n|^2 does
/// not cancel, as a e - b^2 does.
HWY_INLINE V3 between_segments(const Segment& p, const Segment& q) {
  const V3 w = q.a - p.a;
  const V3 n = cross(p.u, q.u);
  const V s0 = clamp01(hn::Mul(dot(cross(w, q.u), n), safe_inverse(squared_norm(n))));
  const V t = clamp01(hn::Mul(dot(mul_add(s0, p.u, negated(w)), q.u), q.inverse_length2));
  const V3 to_q = mul_add(t, q.u, w);
  const V s = clamp01(hn::Mul(dot(to_q, p.u), p.inverse_length2));
  return mul_add(hn::Neg(s), p.u, to_q);
}

HWY_INLINE V segment_segment(const Segment& p, const Segment& q) {
  return squared_norm(between_segments(p, q));
}

HWY_INLINE V3 rotate(const float* r, const V3& v) {
  return {hn::MulAdd(splat(r[0]), v.x, hn::MulAdd(splat(r[1]), v.y, hn::Mul(splat(r[2]), v.z))),
          hn::MulAdd(splat(r[3]), v.x, hn::MulAdd(splat(r[4]), v.y, hn::Mul(splat(r[5]), v.z))),
          hn::MulAdd(splat(r[6]), v.x, hn::MulAdd(splat(r[7]), v.y, hn::Mul(splat(r[8]), v.z)))};
}

/// x minus its nearest value in [-h, h].
HWY_INLINE V excess(V x, V h) { return hn::Sub(x, hn::Max(hn::Min(x, h), hn::Neg(h))); }
HWY_INLINE V3 excess(const V3& x, const V3& h) {
  return {excess(x.x, h.x), excess(x.y, h.y), excess(x.z, h.z)};
}

/// Distance to a box about the origin.
HWY_INLINE V point_box(const V3& p, const V3& half_extents) {
  return squared_norm(excess(p, half_extents));
}

/// Distance to a box about the origin. Along the segment the squared distance is convex and
/// piecewise quadratic: its slope is monotone, and linear between the six parameters where a
/// coordinate crosses a face. The two parameters (or ends) that bracket the sign change give the
/// minimum exactly.
HWY_INLINE V segment_box(const V3& a, const V3& u, const V3& h) {
  const V zero = hn::Zero(Tag());
  V t_low = zero, t_high = splat(1.0f);
  V slope_low = dot(excess(a, h), u);
  V slope_high = dot(excess(a + u, h), u);
  const auto narrow = [&](V a_i, V u_i, V h_i) {
    const M is_moving = hn::Gt(hn::Abs(u_i), splat(1e-12f));
    const V inverse = hn::IfThenElseZero(is_moving, hn::Div(splat(1.0f), u_i));
    for (const V face : {h_i, hn::Neg(h_i)}) {
      const V t = clamp01(hn::Mul(hn::Sub(face, a_i), inverse));
      const V slope = dot(excess(mul_add(t, u, a), h), u);
      const M raises_low = hn::And(hn::Le(slope, zero), hn::Gt(t, t_low));
      const M lowers_high = hn::And(hn::Ge(slope, zero), hn::Lt(t, t_high));
      t_low = hn::IfThenElse(raises_low, t, t_low);
      slope_low = hn::IfThenElse(raises_low, slope, slope_low);
      t_high = hn::IfThenElse(lowers_high, t, t_high);
      slope_high = hn::IfThenElse(lowers_high, slope, slope_high);
    }
  };
  narrow(a.x, u.x, h.x);
  narrow(a.y, u.y, h.y);
  narrow(a.z, u.z, h.z);
  const V rise = hn::Sub(slope_high, slope_low);
  const V step = hn::IfThenZeroElse(hn::Lt(rise, splat(1e-30f)), hn::Div(hn::Neg(slope_low), rise));
  const V t = hn::MulAdd(clamp01(step), hn::Sub(t_high, t_low), t_low);
  return squared_norm(excess(mul_add(t, u, a), h));
}

/// A cylinder about the origin, along z. `excess_of` leads from it to a point; zero inside.
struct CylinderSize {
  V radius, half_length;

  HWY_INLINE V3 excess_of(const V3& p) const {
    const V r = hn::Sqrt(hn::MulAdd(p.x, p.x, hn::Mul(p.y, p.y)));
    const V beyond_side = hn::Div(hn::Max(hn::Sub(r, radius), hn::Zero(Tag())), hn::Max(r, radius));
    return {hn::Mul(beyond_side, p.x), hn::Mul(beyond_side, p.y), excess(p.z, half_length)};
  }
};

HWY_INLINE V point_cylinder(const V3& p, V radius, V half_length) {
  const V r = hn::Sqrt(hn::MulAdd(p.x, p.x, hn::Mul(p.y, p.y)));
  const V zero = hn::Zero(Tag());
  const V side = hn::Max(hn::Sub(r, radius), zero);
  const V end = hn::Max(hn::Sub(hn::Abs(p.z), half_length), zero);
  return hn::MulAdd(side, side, hn::Mul(end, end));
}

/// The squared distance from a convex solid is convex along a segment: bisects the sign change of
/// its slope down to 1e-6 of the segment.
HWY_INLINE V segment_cylinder(const V3& a, const V3& u, const CylinderSize& cylinder) {
  const V zero = hn::Zero(Tag());
  V low = zero, width = splat(1.0f);
  for (int halving = 0; halving < 20; ++halving) {
    width = hn::Mul(width, splat(0.5f));
    const V middle = hn::Add(low, width);
    const V slope = dot(cylinder.excess_of(mul_add(middle, u, a)), u);
    low = hn::IfThenElse(hn::Lt(slope, zero), middle, low);
  }
  const V t = hn::MulAdd(width, splat(0.5f), low);
  return hn::Min(squared_norm(cylinder.excess_of(a)),
                 hn::Min(squared_norm(cylinder.excess_of(a + u)),
                         squared_norm(cylinder.excess_of(mul_add(t, u, a)))));
}

// Signed distances from a solid, negative inside, with the direction away from it.

/// From a point; `apart` leads from there, and `normal` is its direction.
HWY_INLINE V clearance_of_core(const V3& apart, V3& normal) {
  const V distance = hn::Sqrt(hn::Max(squared_norm(apart), splat(1e-18f)));
  normal = hn::Div(splat(1.0f), distance) * apart;
  return distance;
}

/// Signed distance from a box about the origin.
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

/// Signed distance from a cylinder about the origin, along z.
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

HWY_INLINE V3 into_frame(const ObstacleRow& row, const V3& p) {
  return rotate(row.rotation, p - splat(row.center));
}

// Squared distances to an obstacle's core: one class per kind of obstacle.

struct ToSphere {
  const ObstacleRow& row;
  HWY_INLINE V operator()(const V3& p) const { return squared_norm(p - splat(row.center)); }
  HWY_INLINE V operator()(const Segment& s) const { return point_segment(splat(row.center), s); }
};

/// Moves points into the frame of a box or cylinder. `kIsAligned`: the obstacle has the axes of the
/// scene.
template <bool kIsAligned>
struct ToFrame {
  const ObstacleRow& row;
  HWY_INLINE V3 point(const V3& p) const { return direction(p - splat(row.center)); }
  HWY_INLINE V3 direction(const V3& v) const {
    if constexpr (kIsAligned) return v;
    return rotate(row.rotation, v);
  }
};

template <bool kIsAligned>
struct ToBox : ToFrame<kIsAligned> {
  HWY_INLINE V operator()(const V3& p) const {
    return point_box(this->point(p), splat(this->row.half_extents));
  }
  HWY_INLINE V operator()(const Segment& s) const {
    return segment_box(this->point(s.a), this->direction(s.u), splat(this->row.half_extents));
  }
};

template <bool kIsAligned>
struct ToCylinder : ToFrame<kIsAligned> {
  HWY_INLINE V operator()(const V3& p) const {
    const float* size = this->row.half_extents;
    return point_cylinder(this->point(p), splat(size[0]), splat(size[2]));
  }
  HWY_INLINE V operator()(const Segment& s) const {
    const float* size = this->row.half_extents;
    return segment_cylinder(this->point(s.a), this->direction(s.u),
                            {splat(size[0]), splat(size[2])});
  }
};

struct ToCapsule {
  Segment axis;
  HWY_INLINE explicit ToCapsule(const ObstacleRow& row)
      : axis{splat(row.center), splat(row.along), splat(row.inverse_length2)} {}
  HWY_INLINE V operator()(const V3& p) const { return point_segment(p, axis); }
  HWY_INLINE V operator()(const Segment& s) const { return segment_segment(s, axis); }
};

/// Calls `visit` with the distance function of the obstacle's core.
template <class Visit>
HWY_INLINE auto with_distance(const ObstacleRow& row, const Visit& visit) {
  switch (row.kind) {
    case ObstacleKind::aligned_box:
      return visit(ToBox<true>{{row}});
    case ObstacleKind::box:
      return visit(ToBox<false>{{row}});
    case ObstacleKind::upright_cylinder:
      return visit(ToCylinder<true>{{row}});
    case ObstacleKind::cylinder:
      return visit(ToCylinder<false>{{row}});
    case ObstacleKind::capsule:
      return visit(ToCapsule(row));
    case ObstacleKind::sphere:
    case ObstacleKind::compound:  // handled by compound-inl.h
      break;
  }
  return visit(ToSphere{row});
}

/// Distance of `p` from the obstacle's surface, negative inside. `normal` is the unit vector away
/// from it, or 0 at the centre of a sphere and on the axis of a capsule or cylinder.
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

/// About where on a segment it is nearest to a convex obstacle.
HWY_INLINE V nearest_on(const Segment& segment, const ObstacleRow& row) {
  V low = hn::Zero(Tag()), width = splat(1.0f);
  for (int halving = 0; halving < 8; ++halving) {
    width = hn::Mul(width, splat(0.5f));
    const V middle = hn::Add(low, width);
    V3 normal;
    (void)clearance_of(row, mul_add(middle, segment.u, segment.a), normal);
    low = hn::IfThenElse(hn::Lt(dot(normal, segment.u), hn::Zero(Tag())), middle, low);
  }
  return hn::MulAdd(width, splat(0.5f), low);
}

// Bounding boxes of obstacles.

/// The box around balls in all lanes: three coordinates, in arrays that hold a whole vector.
struct Extent {
  static constexpr int kSize = kLanes < 4 ? 4 : kLanes;
  HWY_ALIGN float lower[kSize];
  HWY_ALIGN float upper[kSize];

  HWY_INLINE void set(const V3& center, float radius) {
    store_extent(center, radius, lower, upper);
  }
};

HWY_INLINE M is_below(V distance2, V reach2) { return hn::Lt(distance2, reach2); }
HWY_INLINE M is_below(V distance2, float reach2) { return is_below(distance2, splat(reach2)); }
HWY_INLINE bool is_any_below(V distance2, float reach2) {
  return !hn::AllFalse(Tag(), is_below(distance2, reach2));
}

/// Work of find_overlaps() for `bodies` bodies against all obstacles.
HWY_INLINE std::uint64_t scan_work(const SceneTables& scene, int bodies) {
  return static_cast<std::uint64_t>(bodies) * scene.lower[0].size();
}

/// Returns a bit for each of the kLanes obstacles from `begin` on whose box overlaps `extent`.
HWY_INLINE unsigned find_overlaps(const SceneTables& scene, const Extent& extent, size_t begin) {
  const Tag d;
  M overlap = hn::MaskFromVec(hn::Zero(d));
  for (int axis = 0; axis < 3; ++axis) {
    const M is_below = hn::Le(hn::LoadU(d, &scene.lower[axis][begin]), splat(extent.upper[axis]));
    const M is_above = hn::Ge(hn::LoadU(d, &scene.upper[axis][begin]), splat(extent.lower[axis]));
    const M both = hn::And(is_below, is_above);
    overlap = axis == 0 ? both : hn::And(overlap, both);
  }
  return bits_of(overlap);
}

/// Squared distance to the bounding box of an obstacle; for a segment, from its bounding box.
HWY_INLINE V distance2_to_bounds(const SceneTables& scene, const V3& p, size_t obstacle) {
  const auto beyond = [&](V x, int axis) {
    const V below = hn::Sub(splat(scene.lower[axis][obstacle]), x);
    const V above = hn::Sub(x, splat(scene.upper[axis][obstacle]));
    return hn::Max(hn::Max(below, above), hn::Zero(Tag()));
  };
  return squared_norm(V3{beyond(p.x, 0), beyond(p.y, 1), beyond(p.z, 2)});
}
HWY_INLINE V distance2_to_bounds(const SceneTables& scene, const Segment& s, size_t obstacle) {
  const auto beyond = [&](V from, V along, int axis) {
    const V to = hn::Add(from, along);
    const V below = hn::Sub(splat(scene.lower[axis][obstacle]), hn::Max(from, to));
    const V above = hn::Sub(hn::Min(from, to), splat(scene.upper[axis][obstacle]));
    return hn::Max(hn::Max(below, above), hn::Zero(Tag()));
  };
  return squared_norm(
      V3{beyond(s.a.x, s.u.x, 0), beyond(s.a.y, s.u.y, 1), beyond(s.a.z, s.u.z, 2)});
}

}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#endif  // MNEME_TABLES_DISTANCE_INL_H_
