// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The parts of a compound shape as the kernels read them: plain floats, nothing of Eigen.
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

/// The octants of a voxel lie on either side of its middle along each axis. An occupied octant
/// narrows the clearance of voxels within this number of octants.
inline constexpr int kClearanceReach = 15;
/// The squared clearance of voxels without an occupied octant in reach.
inline constexpr std::uint8_t kWideClearance = kClearanceReach * kClearanceReach;

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

/// A region cut into cubes, and how far from the centre of each there is nothing: so many octants,
/// each half as wide as a voxel, lie between it and the nearest occupied one. Outside of the region
/// there is nothing.
struct VoxelGrid {
  using Index = std::array<int, 3>;

  Middle middle{};
  std::array<float, 3> origin{};  ///< the region's least corner
  float edge = 1;                 ///< edge of a voxel, metres
  float per_metre = 1;            ///< its inverse
  Index count{};                  ///< of voxels along each axis, at least 1
  /// Per voxel, x fastest, a bit for each occupied octant: those with greater x in odd bits. Some
  /// more follow, so that words may be read.
  std::pmr::vector<std::uint8_t> octants;
  /// Per voxel the squared distance of its centre from the nearest occupied octant, in octants.
  /// Some more follow.
  std::pmr::vector<std::uint8_t> clearances;

  /// The octant that holds a point, on each axis between -1 and twice the count: those are outside.
  [[nodiscard]] Index octant_of(const std::array<float, 3>& p) const;
  /// Expects an octant of the grid.
  [[nodiscard]] static std::uint8_t bit_of(const Index& octant) {
    return static_cast<std::uint8_t>(
        1u << ((octant[2] & 1) << 2 | (octant[1] & 1) << 1 | (octant[0] & 1)));
  }
  [[nodiscard]] bool contains(const Index& octant) const;
  /// The slot of the voxel that holds an octant of the grid.
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

/// A grid of empty voxels, in memory of `pages`. `region` is relative to `middle`.
[[nodiscard]] VoxelGrid make_voxel_grid(
    const Region& region, const Middle& middle = {},
    std::pmr::memory_resource* pages = std::pmr::get_default_resource());
/// Finds all clearances anew.
void find_clearances(VoxelGrid& grid);
/// Narrows the clearances around an octant that is occupied from now on.
void occupy(const VoxelGrid::Index& octant, VoxelGrid& grid);

/// Memory of large pages where the system has them, for what is filled at once and soon done with:
/// the first touch of each small page interrupts the program.
[[nodiscard]] std::pmr::memory_resource* large_pages();

/// Finds the clearances of all voxels, along one axis after the other. `scratch` has
/// scratch_size() bytes.
using ClearanceKernel = void (*)(VoxelGrid& grid, std::uint8_t* scratch);
[[nodiscard]] ClearanceKernel clearance_kernel(Isa isa);
[[nodiscard]] std::size_t scratch_size(const VoxelGrid& grid);

// The points of a cloud sorted into voxels; they may be replaced.

inline constexpr int kPointsPerBlock = 8;

/// Points of one voxel; where there is none, coordinates are infinite.
struct PointBlock {
  float x[kPointsPerBlock], y[kPointsPerBlock], z[kPointsPerBlock];
  int next = -1;  ///< block of the same voxel
};

struct PointGrid {
  std::shared_ptr<std::pmr::memory_resource> pages;  ///< of what follows, unless it was copied
  VoxelGrid voxels;
  std::pmr::vector<int> first_block;  ///< per voxel; -1 if it is empty
  std::pmr::vector<PointBlock> blocks;
  Region region{};           ///< points outside of it are left out
  std::size_t size = 0;      ///< points at first
  std::size_t replaced = 0;  ///< points since
};

using PointSpan = std::span<const std::array<float, 3>>;

/// Points outside of `region`, which is relative to `middle`, are left out.
[[nodiscard]] PointGrid make_point_grid(PointSpan points, const Region& region,
                                        const Middle& middle = {});

/// Takes out what stands at `before`, and puts in `after`. False if the grid must be made anew:
/// something lies outside of the voxels though within the region, or so much has been replaced that
/// what is left of it would be slow.
[[nodiscard]] bool replace_points(PointSpan before, PointSpan after, PointGrid& grid);

// Triangles or cubes in a tree of boxes whose leaves are vectors.

/// Parts of a leaf: the lanes of the widest vector.
inline constexpr int kPartsPerLeaf = 16;

struct PartNode {
  float low[3] = {}, high[3] = {};
  int leaf = -1;   ///< index of its block; -1 if it has children
  int right = -1;  ///< the left child follows its parent
};

/// The last triangles of a block may repeat.
struct TriangleBlock {
  float a[3][kPartsPerLeaf];
  float to_b[3][kPartsPerLeaf], to_c[3][kPartsPerLeaf];
  float normal[3][kPartsPerLeaf];  ///< normal_of(), which single precision would turn of thin ones
};

struct CubeBlock {
  float center[3][kPartsPerLeaf];
  float half_extent[kPartsPerLeaf];
};

/// Relative to the middle of the voxels.
struct PartTree {
  VoxelGrid voxels;
  Region region;  ///< parts outside of it are left out of the voxels
  std::vector<PartNode> nodes;
  std::vector<TriangleBlock> triangles;  ///< either these
  std::vector<CubeBlock> cubes;          ///< or these
};

}  // namespace mneme::internal
