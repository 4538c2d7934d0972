// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The inside of a link: points that its surface encloses, and their depth.
#pragma once

#include "spheres/enclosure_grid.h"
#include "spheres/surface_distance.h"
#include "spheres/triangle_mesh.h"

#include <cstdint>
#include <limits>
#include <vector>

namespace mneme::internal {

/// The solid that a surface encloses. Inside is what cannot be reached from outside on a grid
/// without touching the surface: overlapping parts and inner walls do no harm. For surfaces with a
/// rim, points that is_enclosed() proves enclosed are inside, too: a tube without caps is full.
/// Const is parallel-safe.
class SolidModel {
 public:
  explicit SolidModel(const TriangleMesh& mesh);

  [[nodiscard]] bool contains(const Vec3& point) const;
  /// Returns the distance to the outer surface: positive inside, negative outside. Inner walls do
  /// not count.
  [[nodiscard]] double depth(const Vec3& point) const;
  /// Returns the nearest point of the outer surface. `limit` is above the distance.
  [[nodiscard]] Vec3 nearest(const Vec3& point,
                             double limit = std::numeric_limits<double>::infinity()) const {
    return outer_.nearest(point, limit);
  }
  /// Returns -depth() outside and 0 inside.
  [[nodiscard]] double excess(const Vec3& point) const;

  /// Edge length of the grid's voxels, metres.
  [[nodiscard]] double voxel_size() const { return voxel_size_; }
  /// A voxel whose centre is inside; `is_whole` if no surface runs through it.
  struct Voxel {
    Vec3 center;
    bool is_whole = false;
  };
  [[nodiscard]] const std::vector<Voxel>& inner_voxels() const { return inner_voxels_; }
  /// Returns the largest inner balls around voxels near the medial axis. The largest ball around
  /// any other voxel lies within one of them, except for rounding to the grid.
  [[nodiscard]] std::vector<Sphere> medial_balls() const;

 private:
  SolidModel(const TriangleMesh& mesh, bool is_closed);

  enum class Kind : std::uint8_t { unknown, outside, surface, inside };
  using Index = Eigen::Array3i;

  void mark_surface(const TriangleMesh& mesh);
  void flood();
  void fill_open(bool has_rim);
  void collect_inner_voxels();
  [[nodiscard]] bool is_near_outside(const Vec3& point) const;
  [[nodiscard]] Index index_of(const Vec3& point) const;
  [[nodiscard]] bool is_in_grid(const Index& index) const;
  [[nodiscard]] Vec3 center_of(const Index& index) const;
  [[nodiscard]] std::size_t slot(const Index& index) const;
  [[nodiscard]] Index index_at(std::size_t slot) const;

  EnclosureGrid is_enclosed_;
  SurfaceDistance outer_{{}};
  Vec3 origin_;
  double voxel_size_ = 0;
  Index counts_ = Index::Zero();
  std::vector<Kind> kinds_;
  std::vector<Voxel> inner_voxels_;
};

}  // namespace mneme::internal
