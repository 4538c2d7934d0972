// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/compound_grids.h"
#include "base/as_index.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace mneme::internal {
namespace {

/// Metres. Finer voxels take longer to build.
constexpr double kSmallestVoxel = 0.02;
/// Limit on the number of voxels, so that all clearances fit into the L2 cache.
constexpr double kMostVoxels = 1 << 18;
/// Voxels around the parts.
constexpr double kRim = 3;
/// Padding: clearances of a row that are written at once, at least a word of octants.
constexpr int kSpareVoxels = 16;

using Bytes = std::pmr::vector<std::uint8_t>;

constexpr std::uint8_t squared(int octants) {
  return static_cast<std::uint8_t>(std::min(octants * octants, int{kWideClearance}));
}

/// Along one axis, the distance of the centre of voxel `i` from an octant, in octants.
int distance_along(int i, int octant) {
  const int voxel = octant / 2;
  return i == voxel ? 0 : i > voxel ? 2 * i - octant : octant - 2 * i - 1;
}

/// Replaces clearances by the minimum of themselves and of `others` plus `add`. Uses bytes only, so
/// that the compiler vectorizes it.
void narrow(const std::uint8_t* others, std::uint8_t add, std::uint8_t* clearances) {
  std::uint8_t sum[kSpareVoxels];
  const auto most = static_cast<std::uint8_t>(kWideClearance - add);
  for (int i = 0; i < kSpareVoxels; ++i) {
    const std::uint8_t other = others[i];
    sum[i] = static_cast<std::uint8_t>((other < most ? other : most) + add);
  }
  for (int i = 0; i < kSpareVoxels; ++i) {
    const std::uint8_t clearance = clearances[i], nearer = sum[i];
    clearances[i] = nearer < clearance ? nearer : clearance;
  }
}

bool is_occupied(const VoxelGrid& grid, const VoxelGrid::Index& octant) {
  return grid.contains(octant) &&
         (grid.octants[grid.slot_of(octant)] & VoxelGrid::bit_of(octant)) != 0;
}

/// Voxels along one axis.
struct Range {
  int low, high;  ///< low > high where there are none
};

/// The voxels whose clearance an octant may narrow. Voxels nearer to an occupied neighbour are
/// excluded.
Range find_narrowed(const VoxelGrid& grid, const VoxelGrid::Index& octant, std::size_t axis) {
  constexpr int kVoxels = kClearanceReach / 2;
  const int voxel = octant[axis] / 2, is_upper = octant[axis] % 2;
  Range range = {std::max(voxel - kVoxels, 0), std::min(voxel + kVoxels, grid.count[axis] - 1)};
  VoxelGrid::Index neighbour = octant;
  ++neighbour[axis];
  if (is_occupied(grid, neighbour)) range.high = voxel - 1 + is_upper;
  neighbour[axis] -= 2;
  if (is_occupied(grid, neighbour)) range.low = voxel + is_upper;
  return range;
}

constexpr std::size_t kPage = std::size_t{1} << 21;
/// Smaller allocations would waste most of a large page.
constexpr std::size_t kLeast = kPage / 4;

class LargePages : public std::pmr::memory_resource {
  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    if (bytes < kLeast) return ::operator new (bytes, std::align_val_t{alignment});
    const std::size_t whole = (bytes + kPage - 1) / kPage * kPage;
    void* const memory = ::operator new (whole, std::align_val_t{kPage});
#ifdef MADV_HUGEPAGE
    // Failure is harmless: the memory is only slower to fill.
    (void)madvise(memory, whole, MADV_HUGEPAGE);
#endif
    return memory;
  }
  void do_deallocate(void* memory, std::size_t bytes, std::size_t alignment) override {
    ::operator delete (memory, std::align_val_t{bytes < kLeast ? alignment : kPage});
  }
  [[nodiscard]] bool do_is_equal(const memory_resource& other) const noexcept override {
    return this == &other;
  }
};

}  // namespace

std::pmr::memory_resource* large_pages() {
  static LargePages pages;
  return &pages;
}

VoxelGrid::Index VoxelGrid::octant_of(const std::array<float, 3>& p) const {
  Index i;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // The clamp keeps it in the range of int; + 1 makes it positive, so that truncation is floor.
    const float x = (p[axis] - origin[axis]) * (2 * per_metre);
    i[axis] =
        static_cast<int>(std::clamp(x + 1, 0.0f, static_cast<float>(2 * count[axis] + 1))) - 1;
  }
  return i;
}

bool VoxelGrid::contains(const Index& octant) const {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (octant[axis] < 0 || octant[axis] >= 2 * count[axis]) return false;
  }
  return true;
}

VoxelGrid make_voxel_grid(const Region& region, const Middle& middle,
                          std::pmr::memory_resource* pages) {
  std::array<double, 3> extent{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    extent[axis] = double{region.high[axis]} - region.low[axis];
  double voxel = kSmallestVoxel;
  const auto voxels = [&](std::size_t axis) { return std::ceil(extent[axis] / voxel + 2 * kRim); };
  while (voxels(0) * voxels(1) * voxels(2) > kMostVoxels) voxel *= 1.1;
  std::array<float, 3> origin{};
  VoxelGrid::Index count{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    count[axis] = static_cast<int>(voxels(axis));
    origin[axis] = static_cast<float>(region.low[axis] - kRim * voxel);
  }
  const std::size_t size =
      as_index(count[0]) * as_index(count[1]) * as_index(count[2]) + kSpareVoxels;
  const auto edge = static_cast<float>(voxel);
  // Construct in place: assignment would not keep the vectors' allocator.
  return {middle,
          origin,
          edge,
          1 / edge,
          count,
          Bytes(size, std::uint8_t{0}, pages),
          Bytes(size, kWideClearance, pages)};
}

void find_clearances(VoxelGrid& grid) {
  std::pmr::monotonic_buffer_resource pages(scratch_size(grid), large_pages());
  Bytes scratch(scratch_size(grid), &pages);
  clearance_kernel(Isa::automatic)(grid, scratch.data());
}

void occupy(const VoxelGrid::Index& octant, VoxelGrid& grid) {
  assert(grid.contains(octant));
  std::uint8_t& octants = grid.octants[grid.slot_of(octant)];
  const std::uint8_t bit = VoxelGrid::bit_of(octant);
  if ((octants & bit) != 0) return;
  octants |= bit;
  const Range xs = find_narrowed(grid, octant, 0), ys = find_narrowed(grid, octant, 1),
              zs = find_narrowed(grid, octant, 2);
  if (xs.low > xs.high) return;
  std::array<std::uint8_t, kSpareVoxels> along_x;
  static_assert(along_x.size() >= kClearanceReach);
  for (int i = 0; i < kSpareVoxels; ++i) {
    const int x = xs.low + i;
    along_x[as_index(i)] = x <= xs.high ? squared(distance_along(x, octant[0])) : kWideClearance;
  }
  for (int z = zs.low; z <= zs.high; ++z) {
    const int along_z = distance_along(z, octant[2]);
    for (int y = ys.low; y <= ys.high; ++y) {
      const int along_y = distance_along(y, octant[1]);
      const int across = along_z * along_z + along_y * along_y;
      if (across >= kWideClearance) continue;
      std::uint8_t* const row = grid.clearances.data() + grid.slot({xs.low, y, z});
      narrow(along_x.data(), static_cast<std::uint8_t>(across), row);
    }
  }
}

}  // namespace mneme::internal
