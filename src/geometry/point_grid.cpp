// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/compound_grids.h"
#include "base/as_index.h"

#include <algorithm>
#include <array>
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

/// Calls `visit(block, place)` for the places of a voxel until it returns true. True if it did.
template <class Visit>
bool visit_places(PointGrid& grid, std::size_t voxel, const Visit& visit) {
  for (int b = grid.first_block[voxel]; b >= 0; b = grid.blocks[as_index(b)].next) {
    for (int i = 0; i < kPointsPerBlock; ++i) {
      if (visit(grid.blocks[as_index(b)], i)) return true;
    }
  }
  return false;
}

/// A point within the grid, relative to its middle, with its octant and voxel.
struct Placed {
  Point3 p;
  VoxelGrid::Index octant;
  std::size_t voxel;
};

void take_out(const Placed& placed, PointGrid& grid) {
  const Point3& p = placed.p;
  visit_places(grid, placed.voxel, [&](PointBlock& block, int place) {
    const bool is_it = block.x[place] == p[0] && block.y[place] == p[1] && block.z[place] == p[2];
    if (is_it) put({kNowhere, kNowhere, kNowhere}, place, block);
    return is_it;
  });
}

void put_in(const Placed& placed, PointGrid& grid) {
  occupy(placed.octant, grid.voxels);
  const bool has_place = visit_places(grid, placed.voxel, [&](PointBlock& block, int place) {
    if (block.x[place] != kNowhere) return false;
    put(placed.p, place, block);
    return true;
  });
  if (has_place) return;
  grid.blocks.push_back(empty_block());
  grid.blocks.back().next = grid.first_block[placed.voxel];
  put(placed.p, 0, grid.blocks.back());
  grid.first_block[placed.voxel] = static_cast<int>(grid.blocks.size()) - 1;
}

/// Calls `visit(placed)` for the points within the region. Returns false if some are outside of the
/// voxels; these are skipped. `fetch(voxel)` prefetches: neighbours in a cloud may be far apart in
/// memory.
template <class Fetch, class Visit>
bool visit_points(PointSpan points, const PointGrid& grid, const Fetch& fetch, const Visit& visit) {
  constexpr std::size_t kAhead = 32;
  std::array<Placed, kAhead> batch;
  bool are_all_inside = true;
  for (std::size_t first = 0; first < points.size(); first += kAhead) {
    std::size_t count = 0;
    for (const Point3& point : points.subspan(first, std::min(kAhead, points.size() - first))) {
      const Point3 p = relative_to(grid.voxels.middle, point);
      if (!grid.region.contains(p)) continue;
      const VoxelGrid::Index octant = grid.voxels.octant_of(p);
      if (!grid.voxels.contains(octant)) {
        are_all_inside = false;
        continue;
      }
      batch[count] = {p, octant, grid.voxels.slot_of(octant)};
      __builtin_prefetch(&grid.first_block[batch[count].voxel]);
      ++count;
    }
    for (std::size_t i = 0; i < count; ++i) fetch(batch[i].voxel);
    for (std::size_t i = 0; i < count; ++i) visit(batch[i]);
  }
  return are_all_inside;
}

void fetch_block(const PointBlock* block) {
  constexpr std::size_t kLine = 64;
  for (std::size_t at = 0; at < sizeof(PointBlock); at += kLine) {
    __builtin_prefetch(reinterpret_cast<const char*>(block) + at);
  }
}

/// The box around the points within `region`, which is relative to `middle`.
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

/// Allocates blocks. Replaces each voxel's number of points by the place after its last point.
void lay_out_blocks(PointGrid& grid) {
  const auto blocks_of = [](int points) {
    return (points + kPointsPerBlock - 1) / kPointsPerBlock;
  };
  int total = 0;
  for (const int points : grid.first_block) total += blocks_of(points);
  // Spare blocks for points that replace others.
  grid.blocks.reserve(as_index(total + total / 4));
  grid.blocks.resize(as_index(total), empty_block());
  int block = 0;
  for (int& points : grid.first_block) {
    const int first = block, end = block + blocks_of(points);
    for (; block < end - 1; ++block) grid.blocks[as_index(block)].next = block + 1;
    block = end;
    points = points == 0 ? -1 : first * kPointsPerBlock + points;
  }
}

}  // namespace

PointGrid make_point_grid(PointSpan points, const Region& region, const Middle& middle) {
  auto pages =
      std::make_shared<std::pmr::monotonic_buffer_resource>(40 * points.size(), large_pages());
  PointGrid grid{pages,
                 make_voxel_grid(region_around(points, region, middle), middle, pages.get()),
                 std::pmr::vector<int>(pages.get()),
                 std::pmr::vector<PointBlock>(pages.get()),
                 region,
                 points.size(),
                 0};
  grid.first_block.resize(grid.voxels.size(), 0);
  visit_points(
      points, grid, [&](std::size_t voxel) { __builtin_prefetch(&grid.voxels.octants[voxel], 1); },
      [&](const Placed& placed) {
        ++grid.first_block[placed.voxel];
        grid.voxels.octants[placed.voxel] |= VoxelGrid::bit_of(placed.octant);
      });
  lay_out_blocks(grid);
  visit_points(
      points, grid,
      [&](std::size_t voxel) {
        fetch_block(&grid.blocks[as_index((grid.first_block[voxel] - 1) / kPointsPerBlock)]);
      },
      [&](const Placed& placed) {
        const int place = --grid.first_block[placed.voxel];
        put(placed.p, place % kPointsPerBlock, grid.blocks[as_index(place / kPointsPerBlock)]);
      });
  for (int& first : grid.first_block) first = first < 0 ? -1 : first / kPointsPerBlock;
  find_clearances(grid.voxels);
  return grid;
}

bool replace_points(PointSpan before, PointSpan after, PointGrid& grid) {
  // Clearances are not widened where voxels become empty.
  grid.replaced += after.size();
  if (grid.replaced > grid.size) return false;
  const auto fetch = [&](std::size_t voxel) {
    __builtin_prefetch(&grid.voxels.octants[voxel], 1);
    if (grid.first_block[voxel] >= 0) fetch_block(&grid.blocks[as_index(grid.first_block[voxel])]);
  };
  visit_points(before, grid, fetch, [&](const Placed& placed) { take_out(placed, grid); });
  return visit_points(after, grid, fetch, [&](const Placed& placed) { put_in(placed, grid); });
}

}  // namespace mneme::internal
