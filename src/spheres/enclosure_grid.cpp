// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "spheres/enclosure_grid.h"

#include "base/as_index.h"
#include "base/threads.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace mneme::internal {
namespace {

/// Metres by which projections grow, against rounding.
constexpr double kProjectionSpare = 1e-9;
constexpr int kMostCellsPerSide = 512;
/// Entries of all cells per triangle: large triangles get large cells.
constexpr std::size_t kMostEntries = 16;

}  // namespace

LineGrid::LineGrid(const TriangleMesh& mesh, const Vec3& direction) {
  const Vec3 u = direction.unitOrthogonal();
  plane_.row(0) = u.transpose();
  plane_.row(1) = direction.cross(u).normalized().transpose();
  Eigen::Vector2d high = Eigen::Vector2d::Constant(-std::numeric_limits<double>::infinity());
  low_ = -high;
  for (const Triangle& t : mesh) {
    for (const Vec3& corner : {t.a, t.b, t.c}) {
      low_ = low_.cwiseMin(projected(corner));
      high = high.cwiseMax(projected(corner));
    }
  }
  const double extent = std::max((high - low_).maxCoeff(), kProjectionSpare);
  side_ = std::clamp(static_cast<int>(2 * std::sqrt(static_cast<double>(mesh.size()))), 1,
                     kMostCellsPerSide);
  size_ = extent / side_;
  while (side_ > 1 && count_entries(mesh) > kMostEntries * mesh.size()) {
    side_ = (side_ + 1) / 2;
    size_ = extent / side_;
  }
  starts_.assign(as_index(side_ * side_) + 1, 0);
  for (const Triangle& t : mesh) {
    visit_cells(t, [&](std::size_t cell) { ++starts_[cell + 1]; });
  }
  std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
  indices_.resize(as_index(starts_.back()));
  std::vector<int> next(starts_.begin(), starts_.end() - 1);
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    visit_cells(mesh[i],
                [&](std::size_t cell) { indices_[as_index(next[cell]++)] = static_cast<int>(i); });
  }
}

Eigen::Vector2d LineGrid::projected(const Vec3& point) const { return plane_ * point; }

LineGrid::Cell LineGrid::cell_of(const Eigen::Vector2d& point) const {
  const Eigen::Array2d cell = ((point - low_) / size_).array().floor();
  return {static_cast<int>(std::clamp(cell.x(), 0.0, side_ - 1.0)),
          static_cast<int>(std::clamp(cell.y(), 0.0, side_ - 1.0))};
}

std::pair<LineGrid::Cell, LineGrid::Cell> LineGrid::cells_of(const Triangle& t) const {
  const Eigen::Vector2d a = projected(t.a), b = projected(t.b), c = projected(t.c);
  const Eigen::Vector2d spare = Eigen::Vector2d::Constant(kProjectionSpare);
  return {cell_of(a.cwiseMin(b).cwiseMin(c) - spare), cell_of(a.cwiseMax(b).cwiseMax(c) + spare)};
}

std::size_t LineGrid::count_entries(const TriangleMesh& mesh) const {
  poll_interrupt();
  std::size_t count = 0;
  for (const Triangle& t : mesh) {
    const auto [first, last] = cells_of(t);
    count += as_index((last[0] - first[0] + 1) * (last[1] - first[1] + 1));
  }
  return count;
}

template <class Visit>
void LineGrid::visit_cells(const Triangle& t, const Visit& visit) const {
  const auto [first, last] = cells_of(t);
  for (int y = first[1]; y <= last[1]; ++y) {
    for (int x = first[0]; x <= last[0]; ++x) visit(as_index(y * side_ + x));
  }
}

Crossings LineGrid::crossings(const TriangleMesh& mesh, const Vec3& point, const Line& line) const {
  poll_interrupt();
  const Cell at = cell_of(projected(point));
  const std::size_t cell = as_index(at[1] * side_ + at[0]);
  Crossings crossings;
  for (int i = starts_[cell]; i < starts_[cell + 1]; ++i) {
    line.cross(mesh[as_index(indices_[as_index(i)])], crossings);
  }
  return crossings;
}

EnclosureGrid::EnclosureGrid(TriangleMesh mesh, bool is_closed)
    : mesh_(std::move(mesh)), box_(box_around(mesh_)), is_closed_(is_closed) {
  for (const Vec3& direction : line_directions()) grids_.emplace_back(mesh_, direction);
}

bool EnclosureGrid::operator()(const Vec3& point) const {
  // All crossings of a line through a point outside of the box are on one side of it.
  if (distance2(box_, {point, point}) > 0) return false;
  std::size_t direction = 0;
  const auto next_crossings = [&](const Line& line) {
    return grids_[direction++].crossings(mesh_, point, line);
  };
  if (is_closed_) return winding_number(point, next_crossings).value_or(1) != 0;
  return is_enclosed(point, next_crossings);
}

}  // namespace mneme::internal
