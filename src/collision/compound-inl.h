// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Contacts of balls and capsules, one per lane, with the many small parts of compound shapes.
//
// The configurations of a vector are far apart, so each lane would take its own path through a
// tree. Therefore a grid comes first, for all lanes at once: each voxel has the clearance to the
// nearest part. Only the lanes that the grid does not decide check parts, a vector of parts at a
// time.
#if defined(MNEME_COLLISION_COMPOUND_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MNEME_COLLISION_COMPOUND_INL_H_
#undef MNEME_COLLISION_COMPOUND_INL_H_
#else
#define MNEME_COLLISION_COMPOUND_INL_H_
#endif

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "tables/distance-inl.h"
#include "tables/tables.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {

/// Metres; larger than the rounding error of a clearance.
HWY_INLINE float clearance_tolerance(const VoxelGrid& grid) { return 1e-5f + 2e-4f * grid.edge; }

HWY_INLINE V3 into_compound(const CompoundRow& row, const V3& p) {
  return rotate(row.rotation, p) + splat(row.translation);
}

/// The bytes at these indices. Up to three bytes behind each may be read, too.
template <class Indices>
HWY_INLINE Indices gather_bytes(const uint8_t* bytes, Indices indices) {
  const hn::DFromV<Indices> d;
#if HWY_TARGET == HWY_SCALAR
  return hn::Set(d, bytes[hn::GetLane(indices)]);
#else
  const auto words = hn::GatherOffset(d, reinterpret_cast<const int32_t*>(bytes), indices);
  return hn::And(words, hn::Set(d, 0xff));
#endif
}

/// Returns a bit for each lane in which a part may be closer to `p` than `reach`. The bound: from
/// the point of the grid nearest to `p`, parts are at least the voxel's clearance away, less the
/// distance to the voxel's centre.
HWY_INLINE unsigned find_near(const VoxelGrid& grid, const V3& p, V reach) {
  const Tag d;
  const hn::RebindToSigned<Tag> di;
  using VI = hn::Vec<decltype(di)>;
  const auto voxel_of = [&](V x, int axis, V& beyond, V& from_center) -> VI {
    const V from_origin = hn::Sub(x, splat(grid.origin[axis]));
    const V most = splat(grid.edge * static_cast<float>(grid.count[axis]));
    const V inside = hn::Min(hn::Max(from_origin, hn::Zero(d)), most);
    beyond = hn::Sub(from_origin, inside);
    // A NaN must not lead out of the grid either.
    const VI voxel =
        hn::Min(hn::Max(hn::ConvertTo(di, hn::Mul(inside, splat(grid.per_metre))), hn::Zero(di)),
                hn::Set(di, grid.count[axis] - 1));
    from_center =
        hn::NegMulAdd(hn::Add(hn::ConvertTo(d, voxel), splat(0.5f)), splat(grid.edge), inside);
    return voxel;
  };
  V3 beyond, from_center;
  const VI x = voxel_of(p.x, 0, beyond.x, from_center.x),
           y = voxel_of(p.y, 1, beyond.y, from_center.y),
           z = voxel_of(p.z, 2, beyond.z, from_center.z);
  const VI row = hn::Add(hn::Mul(z, hn::Set(di, grid.count[1])), y);
  const VI slot = hn::Add(hn::Mul(row, hn::Set(di, grid.count[0])), x);
  const float octant = 0.5f * grid.edge;
  const V clearance2 =
      hn::Mul(hn::ConvertTo(d, gather_bytes(grid.clearances.data(), slot)), splat(octant * octant));
  const V wanted = hn::Add(reach, splat(clearance_tolerance(grid)));
  // The rest of the reach within the grid; the square of its sum with the distance to the
  // centre.
  const V left2 =
      hn::NegMulAdd(beyond.x, beyond.x,
                    hn::NegMulAdd(beyond.y, beyond.y,
                                  hn::NegMulAdd(beyond.z, beyond.z, hn::Mul(wanted, wanted))));
  const V off2 = squared_norm(from_center);
  const V product = hn::Sqrt(hn::Max(hn::Mul(left2, off2), hn::Zero(d)));
  const V sum2 = hn::Add(hn::Add(left2, off2), hn::Add(product, product));
  return bits_of(hn::And(hn::Gt(left2, hn::Zero(d)), hn::Lt(clearance2, sum2)));
}

/// A ball or capsule: all points within `reach` of the segment from `a` along `u`.
struct Probe {
  float a[3], u[3];
  float inverse_length2;  ///< 0 for a ball
  float reach;
};

/// True if a voxel farther from all parts proves that nothing is within `reach` of `p`: the empty
/// ball around that voxel contains the ball around `p`.
HWY_INLINE bool is_clear_beyond(const VoxelGrid& grid, const float* p, float reach) {
  constexpr float kVoxelsAway = 3;
  const ptrdiff_t strides[3] = {1, grid.count[0], ptrdiff_t{grid.count[0]} * grid.count[1]};
  float from[3];  // in voxels
  ptrdiff_t slot = 0;
  for (int axis = 0; axis < 3; ++axis) {
    from[axis] = (p[axis] - grid.origin[axis]) * grid.per_metre;
    if (!(from[axis] >= 1 && from[axis] < static_cast<float>(grid.count[axis] - 1))) return false;
    slot += strides[axis] * static_cast<ptrdiff_t>(from[axis]);
  }
  float away[3], norm2 = 1e-9f;
  for (int axis = 0; axis < 3; ++axis) {
    const uint8_t* const clearance = grid.clearances.data() + slot;
    away[axis] = static_cast<float>(clearance[strides[axis]] - clearance[-strides[axis]]);
    norm2 += away[axis] * away[axis];
  }
  float off2 = 0;
  slot = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float there = from[axis] + kVoxelsAway / std::sqrt(norm2) * away[axis];
    if (!(there >= 0 && there < static_cast<float>(grid.count[axis]))) return false;
    const auto voxel = static_cast<ptrdiff_t>(there);
    const float off = static_cast<float>(voxel) + 0.5f - from[axis];
    off2 += off * off;
    slot += strides[axis] * voxel;
  }
  const float wanted = (reach + clearance_tolerance(grid)) * grid.per_metre + std::sqrt(off2);
  return 0.25f * static_cast<float>(grid.clearances[static_cast<size_t>(slot)]) >= wanted * wanted;
}

/// Several points at once, at most a block.
using PointTag = hn::CappedTag<float, kPointsPerBlock>;

HWY_INLINE bool touches(const Probe& probe, const PointBlock& block) {
  const PointTag d;
  using Points = hn::Vec<PointTag>;
  const auto set = [&](float value) { return hn::Set(d, value); };
  for (int i = 0; i < kPointsPerBlock; i += static_cast<int>(hn::Lanes(d))) {
    Points x = hn::Sub(hn::LoadU(d, block.x + i), set(probe.a[0]));
    Points y = hn::Sub(hn::LoadU(d, block.y + i), set(probe.a[1]));
    Points z = hn::Sub(hn::LoadU(d, block.z + i), set(probe.a[2]));
    if (probe.inverse_length2 > 0) {
      const Points along = hn::MulAdd(x, set(probe.u[0]),
                                      hn::MulAdd(y, set(probe.u[1]), hn::Mul(z, set(probe.u[2]))));
      const Points t =
          hn::Min(hn::Max(hn::Mul(along, set(probe.inverse_length2)), hn::Zero(d)), set(1.0f));
      x = hn::NegMulAdd(t, set(probe.u[0]), x);
      y = hn::NegMulAdd(t, set(probe.u[1]), y);
      z = hn::NegMulAdd(t, set(probe.u[2]), z);
    }
    const Points distance2 = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
    if (!hn::AllFalse(d, hn::Lt(distance2, set(probe.reach * probe.reach)))) return true;
  }
  return false;
}

/// The voxels that a ball reaches along an axis.
struct VoxelRange {
  int first = 0, last = 0;
  float center = 0;  ///< in voxels

  HWY_INLINE VoxelRange(const VoxelGrid& grid, int axis, float x, float reach) {
    const float most = static_cast<float>(grid.count[axis]);
    const auto in_voxels = [&](float value) {
      return std::min(std::max((value - grid.origin[axis]) * grid.per_metre, -2.0f), most + 1.0f);
    };
    center = (x - grid.origin[axis]) * grid.per_metre;
    first = std::max(static_cast<int>(std::floor(in_voxels(x - reach))), 0);
    last = std::min(static_cast<int>(std::floor(in_voxels(x + reach))), grid.count[axis] - 1);
  }
  /// Squared distance of a voxel from the centre, in voxels.
  [[nodiscard]] HWY_INLINE float distance2(int i) const {
    const float below = static_cast<float>(i) - center, above = center - static_cast<float>(i + 1);
    const float beyond = std::max(std::max(below, above), 0.0f);
    return beyond * beyond;
  }
};

/// True if a point of a voxel is within the probe's reach.
HWY_INLINE bool touches_voxel(const PointGrid& grid, size_t voxel, const Probe& probe) {
  for (int b = grid.first_block[voxel]; b >= 0; b = grid.blocks[static_cast<size_t>(b)].next) {
    if (touches(probe, grid.blocks[static_cast<size_t>(b)])) return true;
  }
  return false;
}

/// True if a point in one of the voxels within `ball_reach` of `center` is within the probe's
/// reach.
HWY_INLINE bool touches_around(const PointGrid& grid, const float* center, float ball_reach,
                               const Probe& probe) {
  const VoxelGrid& voxels = grid.voxels;
  const float reach = ball_reach + clearance_tolerance(voxels);
  const VoxelRange xs(voxels, 0, center[0], reach), ys(voxels, 1, center[1], reach),
      zs(voxels, 2, center[2], reach);
  const float reach2 = reach * reach * voxels.per_metre * voxels.per_metre;
  // From the middle up, then from below: most contacts are in the middle.
  const int layers = zs.last - zs.first + 1;
  for (int k = 0; k < layers; ++k) {
    const int z = zs.first + (k + layers / 2) % layers;
    const float z2 = zs.distance2(z);
    // Eight voxels of a row at once, one per byte of a word: most have no parts.
    for (int x = xs.first; x <= xs.last; x += 8) {
      const int beyond = 8 * std::max(x + 7 - xs.last, 0);
      for (int y = ys.first; y <= ys.last; ++y) {
        const size_t first = voxels.slot({x, y, z});
        uint64_t word;
        std::memcpy(&word, voxels.octants.data() + first, sizeof word);
        for (word = word << beyond >> beyond; word != 0;) {
          const int i = __builtin_ctzll(word) / 8;
          word &= ~(uint64_t{0xff} << (8 * i));
          if (z2 + ys.distance2(y) + xs.distance2(x + i) < reach2 &&
              touches_voxel(grid, first + static_cast<size_t>(i), probe)) {
            return true;
          }
        }
      }
    }
  }
  return false;
}

/// A capsule is checked in stretches as long as two voxels.
static HWY_NOINLINE bool touches(const PointGrid& grid, const Probe& probe) {
  if (probe.inverse_length2 == 0) {
    return !is_clear_beyond(grid.voxels, probe.a, probe.reach) &&
           touches_around(grid, probe.a, probe.reach, probe);
  }
  const float length = 1 / std::sqrt(probe.inverse_length2);
  const int stretches = std::max(1, static_cast<int>(length / (2 * grid.voxels.edge)));
  const float half = 0.5f / static_cast<float>(stretches);
  for (int i = 0; i < stretches; ++i) {
    const float t = static_cast<float>(2 * i + 1) * half;
    const float center[3] = {probe.a[0] + t * probe.u[0], probe.a[1] + t * probe.u[1],
                             probe.a[2] + t * probe.u[2]};
    if (touches_around(grid, center, probe.reach + half * length, probe)) return true;
  }
  return false;
}

// Triangles and cubes: one per lane.

/// Triangles of a block.
struct Facets {
  V3 a, to_b, to_c;
  V3 normal;  ///< to_b x to_c; zero for slivers, which are checked by their edges
};

/// Squared distance from triangles.
HWY_INLINE V point_triangle(const V3& p, const Facets& t) {
  const V3 from_a = p - t.a, to_c_from_b = t.to_c - t.to_b;
  const V area2 = squared_norm(t.normal);
  const V zero = hn::Zero(Tag());
  const auto is_left = [&](const V3& edge, const V3& from) {
    return hn::Ge(dot(t.normal, cross(edge, from)), zero);
  };
  const M is_inside =
      hn::And(hn::And(is_left(t.to_b, from_a), is_left(to_c_from_b, from_a - t.to_b)),
              hn::And(is_left(negated(t.to_c), from_a - t.to_c), hn::Gt(area2, splat(1e-24f))));
  const V height = dot(t.normal, from_a);
  const V from_plane = hn::Div(hn::Mul(height, height), hn::Max(area2, splat(1e-24f)));
  const auto from_edge = [&](const V3& from, const V3& edge) {
    const V along = clamp01(hn::Mul(dot(from, edge), safe_inverse(squared_norm(edge))));
    return squared_norm(mul_add(hn::Neg(along), edge, from));
  };
  const V from_edges =
      hn::Min(from_edge(from_a, t.to_b),
              hn::Min(from_edge(from_a, t.to_c), from_edge(from_a - t.to_b, to_c_from_b)));
  return hn::IfThenElse(is_inside, from_plane, from_edges);
}

/// Lanes in which the segment crosses the triangle from one side to the other.
HWY_INLINE M crosses_triangle(const Segment& s, const Facets& t) {
  const V zero = hn::Zero(Tag()), one = splat(1.0f);
  const V3 from = t.a - s.a, moment = cross(from, s.u);
  const V rise = dot(t.normal, s.u);
  const V inverse = safe_inverse(hn::Abs(rise));
  const V sign = hn::CopySign(one, rise);
  const auto ratio = [&](V value) { return hn::Mul(hn::Mul(value, sign), inverse); };
  const V u = ratio(dot(moment, t.to_c)), v = ratio(hn::Neg(dot(moment, t.to_b)));
  const V along = ratio(dot(t.normal, from));
  const M is_in_triangle =
      hn::And(hn::And(hn::Ge(u, zero), hn::Ge(v, zero)), hn::Le(hn::Add(u, v), one));
  return hn::And(hn::And(is_in_triangle, hn::Gt(inverse, zero)),
                 hn::And(hn::Ge(along, zero), hn::Le(along, one)));
}

HWY_INLINE V segment_triangle(const Segment& s, const Facets& t) {
  const auto edge = [](const V3& from, const V3& along) {
    return Segment{from, along, safe_inverse(squared_norm(along))};
  };
  const V from_ends = hn::Min(point_triangle(s.a, t), point_triangle(s.a + s.u, t));
  const V from_edges = hn::Min(segment_segment(s, edge(t.a, t.to_b)),
                               hn::Min(segment_segment(s, edge(t.a, t.to_c)),
                                       segment_segment(s, edge(t.a + t.to_b, t.to_c - t.to_b))));
  return hn::IfThenZeroElse(crosses_triangle(s, t), hn::Min(from_ends, from_edges));
}

HWY_INLINE Segment axis_of(const Probe& probe) {
  return {splat(probe.a), splat(probe.u), splat(probe.inverse_length2)};
}

HWY_INLINE V3 load(const float (*rows)[kPartsPerLeaf], int i) {
  const Tag d;
  return {hn::LoadU(d, rows[0] + i), hn::LoadU(d, rows[1] + i), hn::LoadU(d, rows[2] + i)};
}

HWY_INLINE V distance2(const Probe& probe, const TriangleBlock& block, int i) {
  const Facets triangles = {load(block.a, i), load(block.to_b, i), load(block.to_c, i),
                            load(block.normal, i)};
  return probe.inverse_length2 > 0 ? segment_triangle(axis_of(probe), triangles)
                                   : point_triangle(splat(probe.a), triangles);
}

HWY_INLINE V distance2(const Probe& probe, const CubeBlock& block, int i) {
  const V half = hn::LoadU(Tag(), block.half_extent + i);
  const V3 a = splat(probe.a) - load(block.center, i);
  return probe.inverse_length2 > 0 ? segment_box(a, splat(probe.u), {half, half, half})
                                   : point_box(a, {half, half, half});
}

template <class Block>
HWY_INLINE bool touches_block(const Probe& probe, const Block& block) {
  for (int i = 0; i < kPartsPerLeaf; i += kLanes) {
    const V reach2 = splat(probe.reach * probe.reach);
    if (!hn::AllFalse(Tag(), hn::Lt(distance2(probe, block, i), reach2))) return true;
  }
  return false;
}

/// Squared distance between the bounding box of the probe's axis and the box of a node.
HWY_INLINE float distance2_to_node(const PartNode& node, const float* low, const float* high) {
  float sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float clearance =
        std::max(std::max(node.low[axis] - high[axis], low[axis] - node.high[axis]), 0.0f);
    sum += clearance * clearance;
  }
  return sum;
}

static HWY_NOINLINE bool touches(const PartTree& tree, const Probe& probe) {
  float low[3], high[3];
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = std::min(probe.a[axis], probe.a[axis] + probe.u[axis]);
    high[axis] = std::max(probe.a[axis], probe.a[axis] + probe.u[axis]);
  }
  const float reach2 = probe.reach * probe.reach;
  // A tree of halves is at most as deep as an index has bits.
  int open[32];
  int count = 0;
  open[count++] = 0;
  while (count > 0) {
    const int index = open[--count];
    const PartNode& node = tree.nodes[static_cast<size_t>(index)];
    if (node.leaf >= 0) {
      const auto leaf = static_cast<size_t>(node.leaf);
      if (tree.cubes.empty() ? touches_block(probe, tree.triangles[leaf])
                             : touches_block(probe, tree.cubes[leaf])) {
        return true;
      }
      continue;
    }
    int near = index + 1, far = node.right;
    float near2 = distance2_to_node(tree.nodes[static_cast<size_t>(near)], low, high);
    float far2 = distance2_to_node(tree.nodes[static_cast<size_t>(far)], low, high);
    if (far2 < near2) {
      std::swap(near, far);
      std::swap(near2, far2);
    }
    if (far2 < reach2) open[count++] = far;
    if (near2 < reach2) open[count++] = near;
  }
  return false;
}

HWY_INLINE bool touches(const CompoundRow& row, const Probe& probe) {
  return row.points != nullptr ? touches(*row.points, probe) : touches(*row.tree, probe);
}

/// The lanes' points and reaches, for access one by one.
struct LanePoints {
  HWY_ALIGN float x[kLanes];
  HWY_ALIGN float y[kLanes];
  HWY_ALIGN float z[kLanes];
  HWY_ALIGN float reach[kLanes];

  HWY_INLINE LanePoints(const V3& p, V radius) {
    hn::Store(p.x, Tag(), x);
    hn::Store(p.y, Tag(), y);
    hn::Store(p.z, Tag(), z);
    hn::Store(radius, Tag(), reach);
  }
};

/// Returns a bit for each lane of `near` whose probe, made by `make_probe(lane)`, touches a part.
/// With `kIsMotion` it stops at the first.
template <bool kIsMotion, class MakeProbe>
HWY_INLINE unsigned find_touches(const CompoundRow& row, unsigned near,
                                 const MakeProbe& make_probe) {
  unsigned hits = 0;
  for (; near != 0; near &= near - 1) {
    const int lane = __builtin_ctz(near);
    if (!touches(row, make_probe(lane))) continue;
    hits |= 1u << lane;
    if (kIsMotion) break;
  }
  return hits;
}

/// find_touches for balls of radius `reach` about `p`, in the frame of the parts.
template <bool kIsMotion>
HWY_INLINE unsigned find_ball_touches(const CompoundRow& row, const V3& p, V reach, unsigned open) {
  const unsigned near = open & find_near(*row.voxels, p, reach);
  if (near == 0) return 0;
  const LanePoints points(p, reach);
  return find_touches<kIsMotion>(row, near, [&](int lane) {
    return Probe{{points.x[lane], points.y[lane], points.z[lane]}, {}, 0, points.reach[lane]};
  });
}

/// find_touches for capsules about segments of one length.
template <bool kIsMotion>
HWY_INLINE unsigned find_capsule_touches(const CompoundRow& row, const V3& a, const V3& u,
                                         float inverse_length2, V reach, unsigned open) {
  const float half = inverse_length2 > 0 ? 0.5f / std::sqrt(inverse_length2) : 0.0f;
  const V3 middle = mul_add(splat(0.5f), u, a);
  const unsigned near = open & find_near(*row.voxels, middle, hn::Add(reach, splat(half)));
  if (near == 0) return 0;
  const LanePoints from(a, reach), along(u, reach);
  return find_touches<kIsMotion>(row, near, [&](int lane) {
    return Probe{{from.x[lane], from.y[lane], from.z[lane]},
                 {along.x[lane], along.y[lane], along.z[lane]},
                 inverse_length2,
                 from.reach[lane]};
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#endif  // MNEME_COLLISION_COMPOUND_INL_H_
