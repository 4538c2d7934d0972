// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What the kernels know of the parts of a compound shape: plain floats, nothing of Eigen.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <vector>

namespace mneme::internal {

/// Octants of a voxel lie on either side of its middle along each axis. So many of them around an
/// occupied one know of it.
inline constexpr int kClearanceReach = 15;
/// Of voxels that know of no occupied octant.
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
  /// Of the voxel that holds an octant of the grid.
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

/// Of empty voxels, in memory of `pages`. `region` is relative to `middle`.
[[nodiscard]] VoxelGrid make_voxel_grid(
    const Region& region, const Middle& middle = {},
    std::pmr::memory_resource* pages = std::pmr::get_default_resource());
/// Finds all clearances anew.
void find_clearances(VoxelGrid& grid);
/// Narrows the clearances around an octant that is occupied from now on.
void occupy(const VoxelGrid::Index& octant, VoxelGrid& grid);

}  // namespace mneme::internal
