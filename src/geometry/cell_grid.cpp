// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/cell_grid.h"

#include "base/as_index.h"

#include <algorithm>
#include <cmath>

namespace mneme::internal {
namespace {

/// Metres: finer cells than this tell more, but must be fetched from farther away.
constexpr double kSmallestCell = 0.02;
/// Cells of a grid, about: a megabyte of gaps is what a core's own cache holds.
constexpr double kMostCells = 1 << 20;
/// Cells around the parts.
constexpr double kRim = 3;

/// What a distance of so many cells along an axis adds to the squared gap.
constexpr std::uint8_t gap2(int cells) {
  const int between = cells > 0 ? cells - 1 : 0;
  return static_cast<std::uint8_t>(between * between);
}

/// `to[i] = min(to[i], least of the two + add)`.
void narrow(const std::uint8_t* one, const std::uint8_t* other, std::uint8_t add, int count,
            std::uint8_t* to) {
  for (int i = 0; i < count; ++i) {
    const std::uint8_t nearer = std::min(one[i], other[i]);
    to[i] = std::min<std::uint8_t>(to[i], static_cast<std::uint8_t>(nearer + add));
  }
}

/// Rows of cells, one after the other along an axis, each with all rows within reach.
void narrow_rows(const std::uint8_t* from, int rows, int stride, int width, std::uint8_t* to) {
  for (int row = 0; row < rows; ++row) {
    for (int d = 1; d <= kGapReach; ++d) {
      const int below = std::max(row - d, 0), above = std::min(row + d, rows - 1);
      if (row - d < 0 && row + d >= rows) break;
      const int one = row - d < 0 ? above : below, other = row + d >= rows ? below : above;
      narrow(from + one * stride, from + other * stride, gap2(d), width, to + row * stride);
    }
  }
}

void narrow_along_x(CellGrid& grid) {
  const int width = grid.count[0];
  std::vector<std::uint8_t> padded(as_index(width + 2 * kGapReach), kWideGap);
  for (int row = 0; row < grid.count[1] * grid.count[2]; ++row) {
    std::uint8_t* const gaps = grid.gaps.data() + as_index(row) * as_index(width);
    std::copy_n(gaps, width, padded.begin() + kGapReach);
    for (int d = 1; d <= kGapReach; ++d) {
      const std::uint8_t* const middle = padded.data() + kGapReach;
      narrow(middle - d, middle + d, gap2(d), width, gaps);
    }
  }
}

}  // namespace

CellGrid::Index CellGrid::cell_of(const std::array<float, 3>& p) const {
  Index i;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // Clamped, an int holds it; a cell up, it is not negative: then to cut off is to round down.
    const float x = (p[axis] - origin[axis]) * per_metre;
    i[axis] = static_cast<int>(std::clamp(x + 1, 0.0f, static_cast<float>(count[axis] + 1))) - 1;
  }
  return i;
}

bool CellGrid::contains(const Index& i) const {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (i[axis] < 0 || i[axis] >= count[axis]) return false;
  }
  return true;
}

CellGrid make_cell_grid(const Region& region, const Middle& middle) {
  std::array<double, 3> extent{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    extent[axis] = double{region.high[axis]} - region.low[axis];
  double cell = kSmallestCell;
  const auto cells = [&](std::size_t axis) { return std::ceil(extent[axis] / cell + 2 * kRim); };
  while (cells(0) * cells(1) * cells(2) > kMostCells) cell *= 1.1;
  CellGrid grid;
  grid.middle = middle;
  grid.cell = static_cast<float>(cell);
  grid.per_metre = 1 / grid.cell;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    grid.count[axis] = static_cast<int>(cells(axis));
    grid.origin[axis] = static_cast<float>(region.low[axis] - kRim * cell);
  }
  const std::size_t size =
      as_index(grid.count[0]) * as_index(grid.count[1]) * as_index(grid.count[2]);
  grid.gaps.assign(size, kWideGap);
  return grid;
}

void find_gaps(const std::vector<std::uint8_t>& is_occupied, CellGrid& grid) {
  std::transform(is_occupied.begin(), is_occupied.end(), grid.gaps.begin(),
                 [](std::uint8_t occupied) { return occupied != 0 ? 0 : kWideGap; });
  narrow_along_x(grid);
  const int width = grid.count[0], layer = width * grid.count[1];
  std::vector<std::uint8_t> before = grid.gaps;
  for (int z = 0; z < grid.count[2]; ++z) {
    narrow_rows(before.data() + z * layer, grid.count[1], width, width,
                grid.gaps.data() + z * layer);
  }
  before = grid.gaps;
  narrow_rows(before.data(), grid.count[2], layer, layer, grid.gaps.data());
}

void occupy(const CellGrid::Index& i, CellGrid& grid) {
  CellGrid::Index low, high;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] = std::max(i[axis] - kGapReach, 0);
    high[axis] = std::min(i[axis] + kGapReach, grid.count[axis] - 1);
  }
  std::array<std::uint8_t, 2 * kGapReach + 1> along_x{};
  for (int x = low[0]; x <= high[0]; ++x) along_x[as_index(x - low[0])] = gap2(std::abs(x - i[0]));
  for (int z = low[2]; z <= high[2]; ++z) {
    for (int y = low[1]; y <= high[1]; ++y) {
      const int across = gap2(std::abs(z - i[2])) + gap2(std::abs(y - i[1]));
      if (across >= kWideGap) continue;
      std::uint8_t* const row = grid.gaps.data() + grid.slot({low[0], y, z});
      narrow(along_x.data(), along_x.data(), static_cast<std::uint8_t>(across),
             high[0] - low[0] + 1, row);
    }
  }
}

}  // namespace mneme::internal
