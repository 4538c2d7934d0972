// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Values of separation tables, one configuration per lane.
#if defined(MNEME_TABLES_SEPARATION_TABLE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MNEME_TABLES_SEPARATION_TABLE_INL_H_
#undef MNEME_TABLES_SEPARATION_TABLE_INL_H_
#else
#define MNEME_TABLES_SEPARATION_TABLE_INL_H_
#endif

#include "tables/tables.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {

/// The table's value in the cell of each configuration. Any float is safe.
HWY_INLINE V rings_at(const SeparationTable& table, const V* q) {
  const Tag d;
  const hn::RebindToSigned<Tag> di;
  const hn::RebindToUnsigned<Tag> du;
  auto index = hn::Zero(di);
  for (const SeparationTable::Axis& axis : table.axes) {
    V cell = hn::MulAdd(q[axis.joint], splat(axis.scale), splat(axis.offset));
    if (axis.has_period) {
      const auto cells = static_cast<float>(axis.cells);
      const V turns = hn::Floor(hn::Mul(cell, splat(1 / cells)));
      cell = hn::NegMulAdd(turns, splat(cells), cell);
    }
    const auto last = hn::Set(di, axis.cells - 1);
    const auto kept = hn::Min(hn::Max(hn::ConvertTo(di, cell), hn::Zero(di)), last);
    index = hn::Add(hn::Mul(index, hn::Set(di, axis.cells)), kept);
  }
  static_assert(SeparationTable::kCellsPerWord == 16 && SeparationTable::kBits == 2);
  const auto word = hn::GatherIndex(du, table.rings.data(), hn::ShiftRight<4>(index));
  const auto shift = hn::ShiftLeft<1>(hn::And(index, hn::Set(di, 15)));
  const auto value = hn::And(hn::Shr(word, hn::BitCast(du, shift)), hn::Set(du, 3));
  return hn::ConvertTo(d, hn::BitCast(di, value));
}

/// The value that proves two bodies apart while joints move by up to `cells` cells.
HWY_INLINE V rings_around(V cells) {
  constexpr float kRounding = 1e-5f;
  return hn::MulAdd(cells, splat(1 + kRounding), splat(1));
}

}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#endif  // MNEME_TABLES_SEPARATION_TABLE_INL_H_
