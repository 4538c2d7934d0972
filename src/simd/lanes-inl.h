// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Vectors of points, and functions on lanes that Highway 1.0.3 lacks. Included once per target.
#if defined(MNEME_SIMD_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MNEME_SIMD_LANES_INL_H_
#undef MNEME_SIMD_LANES_INL_H_
#else
#define MNEME_SIMD_LANES_INL_H_
#endif

#include <cstddef>
#include <cstdint>

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {
#if HWY_TARGET == HWY_NEON
/// Highway's functions, with products that are rounded before they are added, as SSE4 and
/// WebAssembly do: all targets of four lanes find the same paths.
namespace hn {
using namespace hwy::HWY_NAMESPACE;  // NOLINT(google-build-using-namespace)
template <class T>
HWY_INLINE T MulAdd(T a, T b, T c) {
  return Add(Mul(a, b), c);
}
template <class T>
HWY_INLINE T MulSub(T a, T b, T c) {
  return Sub(Mul(a, b), c);
}
template <class T>
HWY_INLINE T NegMulAdd(T a, T b, T c) {
  return Sub(c, Mul(a, b));
}
}  // namespace hn
#else
namespace hn = hwy::HWY_NAMESPACE;
#endif

using Tag = hn::ScalableTag<float>;
using V = hn::Vec<Tag>;
using M = hn::Mask<Tag>;

inline constexpr int kLanes = HWY_LANES(float);

HWY_INLINE V splat(float x) { return hn::Set(Tag(), x); }

/// A point per lane.
struct V3 {
  V x, y, z;
};

HWY_INLINE V3 splat(const float* p) { return {splat(p[0]), splat(p[1]), splat(p[2])}; }
HWY_INLINE V3 operator+(const V3& a, const V3& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE V3 operator-(const V3& a, const V3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE V3 operator*(V s, const V3& a) {
  return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}
HWY_INLINE V3 negated(const V3& a) { return {hn::Neg(a.x), hn::Neg(a.y), hn::Neg(a.z)}; }
/// a + s b
HWY_INLINE V3 mul_add(V s, const V3& b, const V3& a) {
  return {hn::MulAdd(s, b.x, a.x), hn::MulAdd(s, b.y, a.y), hn::MulAdd(s, b.z, a.z)};
}
/// s b - a
HWY_INLINE V3 mul_sub(V s, const V3& b, const V3& a) {
  return {hn::MulSub(s, b.x, a.x), hn::MulSub(s, b.y, a.y), hn::MulSub(s, b.z, a.z)};
}
HWY_INLINE V dot(const V3& a, const V3& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
HWY_INLINE V squared_norm(const V3& a) { return dot(a, a); }
HWY_INLINE V3 cross(const V3& a, const V3& b) {
  return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
          hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}
HWY_INLINE V clamp01(V x) { return hn::Min(hn::Max(x, hn::Zero(Tag())), splat(1.0f)); }

/// A bit per lane.
HWY_INLINE unsigned bits_of(M mask) {
  uint8_t bytes[8];
  hn::StoreMaskBits(Tag(), mask, bytes);
  if constexpr (kLanes == 16) return bytes[0] | unsigned{bytes[1]} << 8;
  return bytes[0] & ((1u << kLanes) - 1);
}

HWY_INLINE M mask_of(unsigned bits) {
  const uint8_t bytes[8] = {static_cast<uint8_t>(bits), static_cast<uint8_t>(bits >> 8)};
  return hn::LoadMaskBits(Tag(), bytes);
}

#if HWY_TARGET == HWY_SCALAR

HWY_INLINE void store_extent(const V3& p, float radius, float* HWY_RESTRICT lower,
                             float* HWY_RESTRICT upper) {
  const V* coordinates[3] = {&p.x, &p.y, &p.z};
  for (int i = 0; i < 3; ++i) {
    lower[i] = hn::GetLane(*coordinates[i]) - radius;
    upper[i] = hn::GetLane(*coordinates[i]) + radius;
  }
}

#else

/// {least x, least y, least z, least z} of all lanes, or the greatest ones, in each block of four.
template <class Pick>
HWY_INLINE V pick_lanes(const V3& p, const Pick& pick) {
  const Tag d;
  const hn::Repartition<double, Tag> pairs;
  const auto merge = [&](V a, V b) {
    return pick(hn::InterleaveLower(d, a, b), hn::InterleaveUpper(d, a, b));
  };
  const auto xy = hn::BitCast(pairs, merge(p.x, p.y)), z = hn::BitCast(pairs, merge(p.z, p.z));
  V result = pick(hn::BitCast(d, hn::InterleaveLower(pairs, xy, z)),
                  hn::BitCast(d, hn::InterleaveUpper(pairs, xy, z)));
#if HWY_TARGET <= HWY_AVX3
  result = pick(result, hn::ReverseBlocks(d, result));
#endif
#if HWY_TARGET <= HWY_AVX2
  result = pick(result, hn::SwapAdjacentBlocks(result));
#endif
  return result;
}

/// Writes the least and greatest x, y and z of balls in all lanes to the first three values of
/// `lower` and `upper`. Both arrays must have room for a whole vector.
HWY_INLINE void store_extent(const V3& p, float radius, float* HWY_RESTRICT lower,
                             float* HWY_RESTRICT upper) {
  const V least = pick_lanes(p, [](V a, V b) { return hn::Min(a, b); });
  const V most = pick_lanes(p, [](V a, V b) { return hn::Max(a, b); });
  hn::Store(hn::Sub(least, splat(radius)), Tag(), lower);
  hn::Store(hn::Add(most, splat(radius)), Tag(), upper);
}

#endif

/// Sine and cosine for |x| up to about 1e4: reduction by pi/2 in three terms (Cody and Waite), then
/// minimax polynomials on [-pi/4, pi/4]. Absolute error below 1.5e-7.
HWY_INLINE void sin_cos(V x, V& sine, V& cosine) {
  const Tag d;
  const V quadrant = hn::Round(hn::Mul(x, splat(0.636619772f)));
  V r = hn::NegMulAdd(quadrant, splat(1.5703125f), x);
  r = hn::NegMulAdd(quadrant, splat(4.837512969970703125e-4f), r);
  r = hn::NegMulAdd(quadrant, splat(7.54978995489188e-8f), r);
  const V r2 = hn::Mul(r, r);
  const V s = hn::MulAdd(
      hn::Mul(hn::MulAdd(hn::MulAdd(splat(-1.9515295891e-4f), r2, splat(8.3321608736e-3f)), r2,
                         splat(-1.6666654611e-1f)),
              r2),
      r, r);
  const V c = hn::MulAdd(hn::Mul(hn::MulAdd(hn::MulAdd(splat(2.443315711809948e-5f), r2,
                                                       splat(-1.388731625493765e-3f)),
                                            r2, splat(4.166664568298827e-2f)),
                                 r2),
                         r2, hn::NegMulAdd(splat(0.5f), r2, splat(1.0f)));
  const hn::RebindToSigned<Tag> di;
  const auto n = hn::ConvertTo(di, quadrant);
  const M is_odd = hn::RebindMask(d, hn::TestBit(n, hn::Set(di, 1)));
  const V sine_sign = hn::BitCast(d, hn::ShiftLeft<30>(hn::And(n, hn::Set(di, 2))));
  const V cosine_sign =
      hn::BitCast(d, hn::ShiftLeft<30>(hn::And(hn::Add(n, hn::Set(di, 1)), hn::Set(di, 2))));
  sine = hn::Xor(hn::IfThenElse(is_odd, c, s), sine_sign);
  cosine = hn::Xor(hn::IfThenElse(is_odd, s, c), cosine_sign);
}

}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#endif  // MNEME_SIMD_LANES_INL_H_
