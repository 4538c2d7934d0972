// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Fast tests of many points against one surface: is_enclosed(), by a grid per direction of lines.
#pragma once

#include "geometry/axis_box.h"
#include "geometry/part_distance.h"
#include "spheres/triangle_mesh.h"

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace mneme::internal {

/// The triangles that lines of one direction may cross, by cells of a plane across them.
class LineGrid {
 public:
  LineGrid(const TriangleMesh& mesh, const Vec3& direction);

  /// Crossings of the line through `point`, which has the grid's direction.
  [[nodiscard]] Crossings crossings(const TriangleMesh& mesh, const Vec3& point,
                                    const Line& line) const;

 private:
  using Cell = std::array<int, 2>;

  [[nodiscard]] Eigen::Vector2d projected(const Vec3& point) const;
  [[nodiscard]] Cell cell_of(const Eigen::Vector2d& point) const;
  [[nodiscard]] std::pair<Cell, Cell> cells_of(const Triangle& t) const;
  [[nodiscard]] std::size_t count_entries(const TriangleMesh& mesh) const;
  template <class Visit>
  void visit_cells(const Triangle& t, const Visit& visit) const;

  Eigen::Matrix<double, 2, 3> plane_;
  Eigen::Vector2d low_ = Eigen::Vector2d::Zero();
  double size_ = 1;
  int side_ = 1;              ///< cells along each axis
  std::vector<int> starts_;   ///< per cell its first entry of indices_
  std::vector<int> indices_;  ///< of triangles
};

/// Tells points that one surface encloses: by winding_number() if the surface is closed, otherwise
/// by is_enclosed(). Const is parallel-safe. Cost: the triangles that project on the point, instead
/// of a search of a tree.
class EnclosureGrid {
 public:
  EnclosureGrid(TriangleMesh mesh, bool is_closed);
  [[nodiscard]] bool operator()(const Vec3& point) const;

 private:
  TriangleMesh mesh_;
  AxisBox box_;
  bool is_closed_ = false;
  std::vector<LineGrid> grids_;  ///< one per direction
};

}  // namespace mneme::internal
