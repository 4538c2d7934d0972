// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Data kept with the parts of a compound shape: a tree for exact distances, a grid for kernels.
#pragma once

#include "geometry/axis_box.h"
#include "geometry/box_tree.h"
#include "geometry/compound_grids.h"

#include <algorithm>
#include <array>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace mneme::internal {

/// Corners of a piece of a surface: least and greatest along each axis.
using PieceCorners = std::array<Vec3, 6>;

/// The connected pieces of a surface.
struct SurfacePieces {
  std::vector<PieceCorners> corners;  ///< per piece
  /// True if no piece has a rim and each encloses a volume: winding numbers tell what is inside.
  bool are_solids = false;
};

struct PartsAccess {
  /// Returns a box around all parts. The box is the smallest one until points are replaced, and may
  /// be larger afterwards. Empty if one part has an empty box, such as a cube of negative size.
  template <class Part>
  static AxisBox bounds(const Parts<Part>& parts) {
    const std::lock_guard lock(parts.mutex_);
    if (!parts.bounds_) parts.bounds_ = std::make_shared<AxisBox>(box_around(parts.list_));
    return *std::static_pointer_cast<const AxisBox>(parts.bounds_);
  }

  /// The tree over all parts. Built at the first call.
  template <class Part>
  static std::shared_ptr<const BoxTree> tree(const Parts<Part>& parts) {
    const std::lock_guard lock(parts.mutex_);
    if (!parts.tree_) parts.tree_ = std::make_shared<BoxTree>(boxes_of(parts.list_));
    return std::static_pointer_cast<const BoxTree>(parts.tree_);
  }

  /// The connected pieces of a surface. Found at the first call.
  static std::shared_ptr<const SurfacePieces> pieces(const Parts<Triangle>& surface);

  /// Replaces points from index `first` on, in place, or in a copy if the parts are shared.
  static void replace(PointCloud& cloud, std::size_t first, std::span<const CloudPoint> points);

  /// The kept grid if `is_good(grid)`, otherwise a new one by `make()`, which is kept. Each kind of
  /// parts must have one type `Grid`.
  template <class Grid, class Part, class IsGood, class Make>
  static std::shared_ptr<const Grid> grid(const Parts<Part>& parts, const IsGood& is_good,
                                          const Make& make) {
    const std::lock_guard lock(parts.mutex_);
    auto kept = std::static_pointer_cast<const Grid>(parts.grid_);
    if (!kept || !is_good(*kept)) {
      auto made = std::make_shared<Grid>(make());
      parts.grid_ = made;
      kept = made;
    }
    return kept;
  }
};

/// Returns true if the surface has no rim: each edge has equally many triangles in both directions.
[[nodiscard]] bool is_closed(std::span<const Triangle> surface);

/// VoxelGrid::middle as a vector.
[[nodiscard]] Vec3 middle_of(const VoxelGrid& voxels);

/// The kernels' grid of the parts. `box`, in the parts' frame, must contain all later queries. A
/// kept grid of a larger box is reused.
[[nodiscard]] std::shared_ptr<const PointGrid> share_grid(const Parts<CloudPoint>& parts,
                                                          const AxisBox& box);
[[nodiscard]] std::shared_ptr<const PartTree> share_grid(const Parts<Triangle>& parts,
                                                         const AxisBox& box);
[[nodiscard]] std::shared_ptr<const PartTree> share_grid(const Parts<Cube>& parts,
                                                         const AxisBox& box);

/// Returns the box, in the frame of the parts, around all parts that can touch something within
/// `reach` of the origin.
template <class Part>
AxisBox region_of_interest(const CompoundShape<Part>& compound, double reach) {
  const AxisBox all = PartsAccess::bounds(*compound.parts);
  const Vec3 origin = compound.pose.inverse().translation;
  const Vec3 half = Vec3::Constant(std::min(reach + compound.radius, 1e6));
  const AxisBox box = intersection(all, {origin - half, origin + half});
  return box.is_empty() ? AxisBox{all.low, all.low} : box;
}

}  // namespace mneme::internal
