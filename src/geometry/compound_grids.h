// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The parts of a compound shape as kernels read them: plain floats, no Eigen types.
#pragma once

#include "mneme/base.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <memory_resource>
#include <span>
#include <vector>

namespace mneme::internal {

/// An octant is an eighth of a voxel. Clearances account for octants up to this distance, in
/// octants.
inline constexpr int kClearanceReach = 15;
/// Squared clearance of voxels without an occupied octant in reach.
inline constexpr std::uint8_t kWideClearance = kClearanceReach * kClearanceReach;

/// An axis-aligned box in the parts' frame.
struct Region {
  std::array<float, 3> low{}, high{};

  [[nodiscard]] bool contains(const std::array<float, 3>& p) const {
    return p[0] >= low[0] && p[1] >= low[1] && p[2] >= low[2] && p[0] <= high[0] &&
           p[1] <= high[1] && p[2] <= high[2];
  }
};

/// A point near the parts, in their frame. Float coordinates are relative to it, because parts may
/// be far from the frame's origin.
using Middle = std::array<double, 3>;

[[nodiscard]] inline std::array<float, 3> relative_to(const Middle& middle,
                                                      const std::array<float, 3>& p) {
  return {static_cast<float>(p[0] - middle[0]), static_cast<float>(p[1] - middle[1]),
          static_cast<float>(p[2] - middle[2])};
}

/// A grid of cubic voxels over a region, with occupied octants and clearances. Everything outside
/// of the region is free.
struct VoxelGrid {
  using Index = std::array<int, 3>;

  Middle middle{};
  std::array<float, 3> origin{};  ///< the region's least corner
  float edge = 1;                 ///< edge of a voxel, metres
  float per_metre = 1;            ///< 1 / edge
  Index count{};                  ///< voxels along each axis, at least 1
  /// Per voxel, x fastest: the bits of its occupied octants (see bit_of). Padded, so that words may
  /// be read.
  std::pmr::vector<std::uint8_t> octants;
  /// Per voxel: squared distance from its centre to the nearest occupied octant, in octants.
  /// Padded.
  std::pmr::vector<std::uint8_t> clearances;

  /// The octant at a point. Clamped to -1 .. 2 * count on each axis; these ends are outside.
  [[nodiscard]] Index octant_of(const std::array<float, 3>& p) const;
  /// The octant's bit in `octants`.
  [[nodiscard]] static std::uint8_t bit_of(const Index& octant) {
    return static_cast<std::uint8_t>(
        1u << ((octant[2] & 1) << 2 | (octant[1] & 1) << 1 | (octant[0] & 1)));
  }
  [[nodiscard]] bool contains(const Index& octant) const;
  /// Position of an octant's voxel in `octants` and `clearances`.
  [[nodiscard]] std::size_t slot_of(const Index& octant) const {
    return slot({octant[0] / 2, octant[1] / 2, octant[2] / 2});
  }
  [[nodiscard]] std::size_t slot(const Index& i) const {
    return static_cast<std::size_t>((i[2] * count[1] + i[1]) * count[0] + i[0]);
  }
  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(count[2]) * static_cast<std::size_t>(count[1]) *
           static_cast<std::size_t>(count[0]);
  }
};

/// A grid of empty voxels, allocated from `pages`. `region` is relative to `middle`.
[[nodiscard]] VoxelGrid make_voxel_grid(
    const Region& region, const Middle& middle = {},
    std::pmr::memory_resource* pages = std::pmr::get_default_resource());
/// Computes all clearances.
void find_clearances(VoxelGrid& grid);
/// Marks an octant as occupied and updates the clearances around it.
void occupy(const VoxelGrid::Index& octant, VoxelGrid& grid);

/// Memory with large pages where the system has them. For short-lived data: the first access to
/// each small page would cost a page fault.
[[nodiscard]] std::pmr::memory_resource* large_pages();

/// Computes the clearances of all voxels, one axis after the other. `scratch`: scratch_size()
/// bytes.
using ClearanceKernel = void (*)(VoxelGrid& grid, std::uint8_t* scratch);
[[nodiscard]] ClearanceKernel clearance_kernel(Isa isa);
[[nodiscard]] std::size_t scratch_size(const VoxelGrid& grid);

// Points of a cloud, sorted into voxels.

inline constexpr int kPointsPerBlock = 8;

/// Points of one voxel; unused places have infinite coordinates.
struct PointBlock {
  float x[kPointsPerBlock], y[kPointsPerBlock], z[kPointsPerBlock];
  int next = -1;  ///< next block of the same voxel
};

struct PointGrid {
  std::shared_ptr<std::pmr::memory_resource> pages;  ///< memory of the vectors, unless copied
  VoxelGrid voxels;
  std::pmr::vector<int> first_block;  ///< per voxel; -1 if it is empty
  std::pmr::vector<PointBlock> blocks;
  Region region{};           ///< points outside are ignored
  std::size_t size = 0;      ///< number of points at first
  std::size_t replaced = 0;  ///< number of points replaced since
};

using PointSpan = std::span<const std::array<float, 3>>;

/// Sorts points into voxels. Points outside of `region`, which is relative to `middle`, are
/// ignored.
[[nodiscard]] PointGrid make_point_grid(PointSpan points, const Region& region,
                                        const Middle& middle = {});

/// Removes the points `before` and adds `after`. Returns false if the grid must be rebuilt: a new
/// point is within the region but outside of the voxels, or more points were replaced since the
/// grid was made than it had then.
[[nodiscard]] bool replace_points(PointSpan before, PointSpan after, PointGrid& grid);

// Triangles or cubes in a bounding box tree whose leaves are vectors.

/// Parts per leaf: lanes of the widest vector.
inline constexpr int kPartsPerLeaf = 16;

struct PartNode {
  float low[3] = {}, high[3] = {};
  int leaf = -1;   ///< index of its block; -1 for inner nodes
  int right = -1;  ///< right child; the left child is the next node
};

/// The last triangle may be repeated to fill the block.
struct TriangleBlock {
  float a[3][kPartsPerLeaf];
  float to_b[3][kPartsPerLeaf], to_c[3][kPartsPerLeaf];
  float normal[3][kPartsPerLeaf];  ///< normal_of(); too inexact for thin ones in single precision
};

struct CubeBlock {
  float center[3][kPartsPerLeaf];
  float half_extent[kPartsPerLeaf];
};

/// Coordinates are relative to the middle of the voxels.
struct PartTree {
  VoxelGrid voxels;
  Region region;  ///< parts outside are not in the voxels
  std::vector<PartNode> nodes;
  std::vector<TriangleBlock> triangles;  ///< empty for cubes
  std::vector<CubeBlock> cubes;          ///< empty for triangles
};

}  // namespace mneme::internal
