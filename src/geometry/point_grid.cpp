// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/point_grid.h"

#include "base/as_index.h"

#include <algorithm>
#include <limits>

namespace mneme::internal {
namespace {

constexpr float kNowhere = std::numeric_limits<float>::infinity();

PointBlock empty_block() {
  PointBlock block{};
  for (int i = 0; i < kPointsPerBlock; ++i) block.x[i] = block.y[i] = block.z[i] = kNowhere;
  return block;
}

using Point3 = std::array<float, 3>;

void put(const Point3& p, int place, PointBlock& block) {
  block.x[place] = p[0];
  block.y[place] = p[1];
  block.z[place] = p[2];
}

/// Calls `visit(block, place)` for the places of a cell until it returns true, and says whether it
/// did.
template <class Visit>
bool visit_places(PointGrid& grid, std::size_t cell, const Visit& visit) {
  for (int b = grid.first_block[cell]; b >= 0; b = grid.blocks[as_index(b)].next) {
    for (int i = 0; i < kPointsPerBlock; ++i) {
      if (visit(grid.blocks[as_index(b)], i)) return true;
    }
  }
  return false;
}

void take_out(const Point3& point, PointGrid& grid) {
  const Point3 p = relative_to(grid.cells.middle, point);
  const CellGrid::Index i = grid.cells.cell_of(p);
  if (!grid.region.contains(p) || !grid.cells.contains(i)) return;
  const std::size_t cell = grid.cells.slot(i);
  visit_places(grid, cell, [&](PointBlock& block, int place) {
    const bool is_it = block.x[place] == p[0] && block.y[place] == p[1] && block.z[place] == p[2];
    if (is_it) put({kNowhere, kNowhere, kNowhere}, place, block);
    return is_it;
  });
}

void put_in(const Point3& p, const CellGrid::Index& i, PointGrid& grid) {
  const std::size_t cell = grid.cells.slot(i);
  const bool has_place = visit_places(grid, cell, [&](PointBlock& block, int place) {
    if (block.x[place] != kNowhere) return false;
    put(p, place, block);
    return true;
  });
  if (has_place) return;
  const bool is_new = grid.first_block[cell] < 0;
  grid.blocks.push_back(empty_block());
  grid.blocks.back().next = grid.first_block[cell];
  put(p, 0, grid.blocks.back());
  grid.first_block[cell] = static_cast<int>(grid.blocks.size()) - 1;
  if (is_new) occupy(i, grid.cells);
}

/// The cell of each point; -1 outside.
std::vector<int> find_cells(PointSpan points, const PointGrid& grid) {
  std::vector<int> cells(points.size(), -1);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Point3 p = relative_to(grid.cells.middle, points[k]);
    const CellGrid::Index i = grid.cells.cell_of(p);
    if (grid.region.contains(p) && grid.cells.contains(i)) {
      cells[k] = static_cast<int>(grid.cells.slot(i));
    }
  }
  return cells;
}

/// The box around those within `region`, which is relative to `middle`.
Region region_around(PointSpan points, const Region& region, const Middle& middle) {
  Region box = {region.high, region.low};
  bool is_empty = true;
  for (const Point3& point : points) {
    const Point3 p = relative_to(middle, point);
    if (!region.contains(p)) continue;
    is_empty = false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.low[axis] = std::min(box.low[axis], p[axis]);
      box.high[axis] = std::max(box.high[axis], p[axis]);
    }
  }
  return is_empty ? Region{region.low, region.low} : box;
}

}  // namespace

PointGrid make_point_grid(PointSpan points, const Region& region, const Middle& middle) {
  PointGrid grid;
  grid.region = region;
  grid.size = points.size();
  grid.cells = make_cell_grid(region_around(points, region, middle), middle);
  const std::vector<int> cells = find_cells(points, grid);
  std::vector<int> left(grid.cells.gaps.size(), 0);
  for (const int cell : cells) {
    if (cell >= 0) ++left[as_index(cell)];
  }
  grid.first_block.assign(left.size(), -1);
  grid.blocks.reserve(points.size() / 3);
  std::vector<std::uint8_t> is_occupied(left.size(), 0);
  for (std::size_t cell = 0; cell < left.size(); ++cell) {
    if (left[cell] == 0) continue;
    is_occupied[cell] = 1;
    grid.first_block[cell] = static_cast<int>(grid.blocks.size());
    const int blocks = (left[cell] + kPointsPerBlock - 1) / kPointsPerBlock;
    for (int b = 0; b < blocks; ++b) {
      grid.blocks.push_back(empty_block());
      if (b + 1 < blocks) grid.blocks.back().next = static_cast<int>(grid.blocks.size());
    }
  }
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (cells[k] < 0) continue;
    const std::size_t cell = as_index(cells[k]);
    const int place = --left[cell];
    put(relative_to(grid.cells.middle, points[k]), place % kPointsPerBlock,
        grid.blocks[as_index(grid.first_block[cell] + place / kPointsPerBlock)]);
  }
  find_gaps(is_occupied, grid.cells);
  return grid;
}

bool replace_points(PointSpan before, PointSpan after, PointGrid& grid) {
  // Cells that are empty by now still narrow the gaps around them.
  grid.replaced += after.size();
  if (grid.replaced > grid.size) return false;
  for (const Point3& p : before) take_out(p, grid);
  for (const Point3& point : after) {
    const Point3 p = relative_to(grid.cells.middle, point);
    if (!grid.region.contains(p)) continue;
    const CellGrid::Index i = grid.cells.cell_of(p);
    if (!grid.cells.contains(i)) return false;
    put_in(p, i, grid);
  }
  return true;
}

}  // namespace mneme::internal
