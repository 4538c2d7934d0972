// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/parts.h"

#include "base/as_index.h"

#include <algorithm>
#include <functional>
#include <map>
#include <numeric>
#include <unordered_map>

namespace mneme::internal {
namespace {

struct CornerHash {
  std::size_t operator()(const std::array<double, 3>& p) const {
    const std::hash<double> hash{};
    return (hash(p[0]) * 31 + hash(p[1])) * 31 + hash(p[2]);
  }
};

std::vector<PieceCorners> corners_of_each_piece(const std::vector<Triangle>& triangles) {
  // Union-find: triangles that share a corner belong to one piece.
  std::vector<int> piece(triangles.size());
  std::iota(piece.begin(), piece.end(), 0);
  const auto root_of = [&](int i) {
    while (piece[as_index(i)] != i) i = piece[as_index(i)] = piece[as_index(piece[as_index(i)])];
    return i;
  };
  std::unordered_map<std::array<double, 3>, int, CornerHash> first_at(triangles.size());
  for (int i = 0; i < std::ssize(triangles); ++i) {
    const Triangle& t = triangles[as_index(i)];
    for (const Vec3& corner : {t.a, t.b, t.c}) {
      const auto first = first_at.try_emplace({corner.x(), corner.y(), corner.z()}, i).first;
      piece[as_index(root_of(i))] = root_of(first->second);
    }
  }
  std::map<int, PieceCorners> pieces;
  for (int i = 0; i < std::ssize(triangles); ++i) {
    const Triangle& t = triangles[as_index(i)];
    PieceCorners filled;
    filled.fill(t.a);
    PieceCorners& corners = pieces.try_emplace(root_of(i), filled).first->second;
    for (const Vec3& corner : {t.a, t.b, t.c}) {
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        Vec3 &low = corners[as_index(2 * axis)], &high = corners[as_index(2 * axis + 1)];
        if (corner[axis] < low[axis]) low = corner;
        if (corner[axis] > high[axis]) high = corner;
      }
    }
  }
  std::vector<PieceCorners> result;
  for (const auto& [root, corners] : pieces) result.push_back(corners);
  return result;
}

}  // namespace

std::shared_ptr<const std::vector<PieceCorners>> PartsAccess::pieces(
    const Parts<Triangle>& surface) {
  const std::lock_guard lock(surface.mutex_);
  if (!surface.corners_) {
    surface.corners_ =
        std::make_shared<std::vector<PieceCorners>>(corners_of_each_piece(surface.list_));
  }
  return std::static_pointer_cast<const std::vector<PieceCorners>>(surface.corners_);
}

void PartsAccess::replace(PointCloud& cloud, std::size_t first,
                          std::span<const CloudPoint> points) {
  const Parts<CloudPoint>& old = *cloud.parts;
  auto grid = [&] {
    const std::lock_guard lock(old.mutex_);
    return std::static_pointer_cast<PointGrid>(old.grid_);
  }();
  // Unshared, the grid has two owners: the points and this function.
  const bool is_mine = cloud.parts.use_count() == 1 && grid.use_count() <= 2;
  if (is_mine) {
    // Releasing a reference synchronizes with earlier releases by others; use_count() does not.
    std::shared_ptr(cloud.parts).reset();
    std::shared_ptr(grid).reset();
  }
  // The const_cast is valid: points are always created as objects that are not const.
  auto parts = is_mine ? std::const_pointer_cast<Parts<CloudPoint>>(cloud.parts)
                       : std::make_shared<Parts<CloudPoint>>(old.list_);
  if (grid && !is_mine) grid = std::make_shared<PointGrid>(*grid);
  const std::span<CloudPoint> place(parts->list_.data() + first, points.size());
  if (grid && !replace_points(place, points, *grid)) grid = nullptr;
  std::ranges::copy(points, place.begin());
  AxisBox box = bounds(old);
  for (const CloudPoint& p : points) box.include(box_of(p));
  parts->bounds_ = std::make_shared<AxisBox>(box);
  parts->grid_ = grid;
  parts->tree_ = nullptr;
  cloud.parts = parts;
}

}  // namespace mneme::internal
