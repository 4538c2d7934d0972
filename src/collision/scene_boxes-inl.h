// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// What of a scene a body may touch, by the boxes around obstacles.
#if defined(MNEME_COLLISION_SCENE_BOXES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MNEME_COLLISION_SCENE_BOXES_INL_H_
#undef MNEME_COLLISION_SCENE_BOXES_INL_H_
#else
#define MNEME_COLLISION_SCENE_BOXES_INL_H_
#endif

#include <cstddef>
#include <cstdint>

#include "geometry/solids-inl.h"
#include "tables/tables.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {

/// Where a body is in any lane: three coordinates, in arrays that hold a whole vector.
struct Extent {
  static constexpr int kSize = kLanes < 4 ? 4 : kLanes;
  HWY_ALIGN float lower[kSize];
  HWY_ALIGN float upper[kSize];

  HWY_INLINE void set(const V3& p) { store_extent(p, lower, upper); }
};

HWY_INLINE M is_below(V distance2, V reach2) { return hn::Lt(distance2, reach2); }
HWY_INLINE M is_below(V distance2, float reach2) { return is_below(distance2, splat(reach2)); }
HWY_INLINE bool is_any_below(V distance2, float reach2) {
  return !hn::AllFalse(Tag(), is_below(distance2, reach2));
}

/// One bit for each of the kLanes obstacles from `begin` whose box comes within `reach` of
/// `extent`.
HWY_INLINE unsigned find_overlaps(const SceneTables& scene, const Extent& extent, float reach,
                                  size_t begin) {
  const Tag d;
  M overlap = hn::MaskFromVec(hn::Zero(d));
  for (int axis = 0; axis < 3; ++axis) {
    const M is_below =
        hn::Le(hn::LoadU(d, &scene.lower[axis][begin]), splat(extent.upper[axis] + reach));
    const M is_above =
        hn::Ge(hn::LoadU(d, &scene.upper[axis][begin]), splat(extent.lower[axis] - reach));
    const M both = hn::And(is_below, is_above);
    overlap = axis == 0 ? both : hn::And(overlap, both);
  }
  return bits_of(overlap);
}

/// Squared distance from the box around an obstacle; of a segment, from the box around it.
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

#endif  // MNEME_COLLISION_SCENE_BOXES_INL_H_
