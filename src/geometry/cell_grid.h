// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What the kernels know of the parts of a crowd: plain floats, nothing of Eigen.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace mneme::internal {

/// How many cells around an occupied one know of it.
inline constexpr int kGapReach = 10;
/// Of cells that know of no occupied one.
inline constexpr std::uint8_t kWideGap = kGapReach * kGapReach;

/// A box along the axes of the parts' frame.
struct Region {
  std::array<float, 3> low{}, high{};

  [[nodiscard]] bool contains(const std::array<float, 3>& p) const {
    return p[0] >= low[0] && p[1] >= low[1] && p[2] >= low[2] && p[0] <= high[0] &&
           p[1] <= high[1] && p[2] <= high[2];
  }
};

/// A point of the parts' frame near them, which may lie far from its origin: coordinates in floats
/// are relative to it.
using Middle = std::array<double, 3>;

[[nodiscard]] inline std::array<float, 3> relative_to(const Middle& middle,
                                                      const std::array<float, 3>& p) {
  return {static_cast<float>(p[0] - middle[0]), static_cast<float>(p[1] - middle[1]),
          static_cast<float>(p[2] - middle[2])};
}

/// A region cut into cubes, and how far from each of them there is nothing: so many whole cells lie
/// between it and the nearest occupied one, at least. Outside of the region there is nothing.
struct CellGrid {
  using Index = std::array<int, 3>;

  Middle middle{};
  std::array<float, 3> origin{};  ///< the region's least corner
  float cell = 1;                 ///< edge of a cell, metres
  float per_metre = 1;            ///< its inverse
  Index count{};                  ///< of cells along each axis, at least 1
  /// Per cell, x fastest, the squared gap in cells: 0 of an occupied one and its neighbours.
  std::vector<std::uint8_t> gaps;

  /// The cell that holds a point, on each axis between -1 and count: those are outside.
  [[nodiscard]] Index cell_of(const std::array<float, 3>& p) const;
  [[nodiscard]] bool contains(const Index& i) const;
  [[nodiscard]] std::size_t slot(const Index& i) const {
    return static_cast<std::size_t>((i[2] * count[1] + i[1]) * count[0] + i[0]);
  }
};

/// Of empty cells. `region` is relative to `middle`.
[[nodiscard]] CellGrid make_cell_grid(const Region& region, const Middle& middle = {});
/// Finds all gaps anew. `is_occupied` is 1 or 0 per cell.
void find_gaps(const std::vector<std::uint8_t>& is_occupied, CellGrid& grid);
/// Narrows the gaps around a cell that is occupied from now on.
void occupy(const CellGrid::Index& i, CellGrid& grid);

}  // namespace mneme::internal
