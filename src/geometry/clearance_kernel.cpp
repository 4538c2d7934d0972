// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Compiled once per instruction set. The lanes of a vector are neighbouring voxels of a row.
#include "geometry/compound_grids.h"

#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geometry/clearance_kernel.cpp"  // NOLINT
#include "hwy/foreach_target.h"

#include "simd/dispatch.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {
namespace {

using Bytes = hn::ScalableTag<uint8_t>;

/// Rows whose minimum is taken. A row at distance d adds d^2 to its squared clearances.
class Rows {
 public:
  HWY_INLINE void add(const uint8_t* row, int distance) {
    rows_[count_] = row;
    squared_[count_++] = static_cast<uint8_t>(distance * distance);
  }
  /// Writes the minimum of all rows and kWideClearance.
  HWY_INLINE void narrow_to(uint8_t* to, int width) const {
    constexpr int kNarrow = 16 < kBytes ? 16 : kBytes;
    if (width >= kBytes) {
      narrow_to(Bytes(), to, width);
    } else if (width >= kNarrow) {
      narrow_to(hn::CappedTag<uint8_t, kNarrow>(), to, width);
    } else {
      narrow_to(hn::CappedTag<uint8_t, 1>(), to, width);
    }
  }

 private:
  static constexpr int kBytes = HWY_LANES(uint8_t);

  /// The last vector may overlap the one before.
  template <class D>
  HWY_INLINE void narrow_to(D d, uint8_t* to, int width) const {
    const int lanes = static_cast<int>(hn::Lanes(d));
    for (int i = 0; i < width - lanes; i += lanes) narrow_at(d, i, to);
    narrow_at(d, width - lanes, to);
  }
  template <class D>
  HWY_INLINE void narrow_at(D d, int i, uint8_t* to) const {
    auto least = hn::Set(d, kWideClearance);
    for (int k = 0; k < count_; ++k) {
      const auto clearance = hn::LoadU(d, rows_[k] + i);
      least = hn::Min(least, hn::SaturatedAdd(clearance, hn::Set(d, squared_[k])));
    }
    hn::StoreU(least, d, to + i);
  }

  int count_ = 0;
  const uint8_t* rows_[2 * kClearanceReach];
  uint8_t squared_[2 * kClearanceReach];
};

/// Rows of octants, two per row of voxels. Rows without occupied octants are skipped.
struct OctantRows {
  const uint8_t* data;
  int rows, width;
  const uint8_t* is_used;

  /// Writes the clearances of row `i` of voxels from all rows of octants in reach.
  HWY_INLINE void narrow_row(int i, uint8_t* to) const {
    Rows near;
    for (int d = 0; d < kClearanceReach; ++d) {
      for (const int row : {2 * i - d, 2 * i + 1 + d}) {
        if (row < 0 || row >= rows || is_used[row] == 0) continue;
        near.add(data + static_cast<ptrdiff_t>(row) * width, d);
      }
    }
    near.narrow_to(to, width);
  }
};

/// Expands a layer of octants: 0 where occupied, kWideClearance elsewhere. Each row has the octants
/// with even x first, then those with odd x. Returns false if no octant is occupied.
HWY_INLINE bool spread_layer(const VoxelGrid& grid, int z, uint8_t* rows, uint8_t* is_used) {
  const int width = grid.count[0];
  bool is_any = false;
  for (int y = 0; y < 2 * grid.count[1]; ++y) {
    const uint8_t* octants =
        grid.octants.data() + static_cast<ptrdiff_t>(z / 2 * grid.count[1] + y / 2) * width;
    const int first = (z & 1) << 2 | (y & 1) << 1;
    uint8_t* row = rows + static_cast<ptrdiff_t>(y) * 2 * width;
    unsigned seen = 0;
    for (int x = 0; x < width; ++x) {
      const unsigned pair = unsigned{octants[x]} >> first;
      row[x] = static_cast<uint8_t>(kWideClearance & ((pair & 1) - 1));
      row[width + x] = static_cast<uint8_t>(kWideClearance & ((pair >> 1 & 1) - 1));
      seen |= pair & 3;
    }
    is_used[y] = seen != 0;
    is_any |= seen != 0;
  }
  return is_any;
}

/// A row with padding of kClearanceReach octants on both sides.
struct PaddedRow {
  uint8_t* data;

  HWY_INLINE PaddedRow(uint8_t* memory, int width) : data(memory + kClearanceReach) {
    std::memset(memory, kWideClearance, static_cast<size_t>(width + 2 * kClearanceReach));
  }
};

HWY_INLINE void narrow_along_x(const PaddedRow& lesser, const PaddedRow& greater, int width,
                               uint8_t* to) {
  Rows near;
  for (int d = 0; d < kClearanceReach; ++d) {
    const bool is_odd = d % 2 == 1;
    const int voxels = (d + 1) / 2;
    near.add((is_odd ? greater : lesser).data - voxels, d);
    near.add((is_odd ? lesser : greater).data + voxels, d);
  }
  near.narrow_to(to, width);
}

void find_clearances(VoxelGrid& grid, uint8_t* scratch) {
  const int width = grid.count[0], height = grid.count[1], depth = grid.count[2];
  const int row = 2 * width, layer = row * height;
  uint8_t* const layers = scratch;
  uint8_t* const rows = layers + static_cast<ptrdiff_t>(2 * depth) * layer;
  uint8_t* const narrowed = rows + 2 * layer;
  const PaddedRow lesser(narrowed + layer, width),
      greater(lesser.data + width + kClearanceReach, width);
  uint8_t* const is_row_used = greater.data + width + kClearanceReach;
  uint8_t* const is_layer_used = is_row_used + 2 * height;
  for (int z = 0; z < 2 * depth; ++z) {
    is_layer_used[z] = spread_layer(grid, z, rows, is_row_used);
    if (is_layer_used[z] == 0) continue;
    uint8_t* const to = layers + static_cast<ptrdiff_t>(z) * layer;
    const OctantRows along_y{rows, 2 * height, row, is_row_used};
    for (int y = 0; y < height; ++y) along_y.narrow_row(y, to + y * row);
  }
  const OctantRows along_z{layers, 2 * depth, layer, is_layer_used};
  for (int z = 0; z < depth; ++z) {
    along_z.narrow_row(z, narrowed);
    for (int y = 0; y < height; ++y) {
      std::memcpy(lesser.data, narrowed + y * row, static_cast<size_t>(width));
      std::memcpy(greater.data, narrowed + y * row + width, static_cast<size_t>(width));
      uint8_t* const to = grid.clearances.data() + static_cast<ptrdiff_t>(z * height + y) * width;
      narrow_along_x(lesser, greater, width, to);
    }
  }
}

ClearanceKernel kernel() { return &find_clearances; }

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
MNEME_EXPORT(ClearanceKernel, clearance_kernel, kernel)

namespace mneme::internal {

std::size_t scratch_size(const VoxelGrid& grid) {
  const auto width = static_cast<std::size_t>(grid.count[0]);
  const auto height = static_cast<std::size_t>(grid.count[1]);
  const auto depth = static_cast<std::size_t>(grid.count[2]);
  const std::size_t layer = 2 * width * height;
  return (2 * depth + 3) * layer + 2 * (width + 2 * kClearanceReach) + 2 * height + 2 * depth;
}

}  // namespace mneme::internal
#endif  // HWY_ONCE
