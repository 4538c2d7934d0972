// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/parts.h"

#include "base/as_index.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <unordered_map>
#include <utility>

namespace mneme::internal {
namespace {

struct CornerHash {
  std::size_t operator()(const std::array<double, 3>& p) const {
    const std::hash<double> hash{};
    return (hash(p[0]) * 31 + hash(p[1])) * 31 + hash(p[2]);
  }
};

using CornerNumbers = std::vector<std::array<int, 3>>;

/// Per triangle its corners' numbers: corners at the same coordinates have the same one.
CornerNumbers number_corners(std::span<const Triangle> triangles) {
  std::unordered_map<std::array<double, 3>, int, CornerHash> numbers(triangles.size());
  CornerNumbers result;
  result.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    std::array<int, 3>& corners = result.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3& p = i == 0 ? t.a : i == 1 ? t.b : t.c;
      const int next = static_cast<int>(numbers.size());
      // Adding zero makes -0 the same as 0.
      corners[i] = numbers.try_emplace({p.x() + 0.0, p.y() + 0.0, p.z() + 0.0}, next).first->second;
    }
  }
  return result;
}

bool have_no_rim(const CornerNumbers& triangles) {
  using Edge = std::pair<int, int>;
  std::vector<Edge> edges, reversed;
  for (const auto& corners : triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const int from = corners[i], to = corners[(i + 1) % 3];
      if (from == to) continue;
      edges.emplace_back(from, to);
      reversed.emplace_back(to, from);
    }
  }
  std::ranges::sort(edges);
  std::ranges::sort(reversed);
  return edges == reversed;
}

/// Triangles that share a corner belong to one piece. Returns the number of each triangle's piece.
std::vector<int> number_pieces(const CornerNumbers& triangles) {
  int count = 0;
  for (const auto& corners : triangles) count = std::max(count, 1 + std::ranges::max(corners));
  std::vector<int> up(as_index(count));  // union-find over corners
  std::iota(up.begin(), up.end(), 0);
  const auto root_of = [&](int i) {
    while (up[as_index(i)] != i) i = up[as_index(i)] = up[as_index(up[as_index(i)])];
    return i;
  };
  for (const auto& [a, b, c] : triangles) {
    up[as_index(root_of(a))] = root_of(b);
    up[as_index(root_of(b))] = root_of(c);
  }
  std::vector<int> pieces, number(as_index(count), -1);
  int next = 0;
  for (const auto& corners : triangles) {
    int& piece = number[as_index(root_of(corners[0]))];
    if (piece < 0) piece = next++;
    pieces.push_back(piece);
  }
  return pieces;
}

/// Volume, as an integral over the surface, and area of a piece.
struct PieceSize {
  Vec3 origin;  ///< a point near the piece, against rounding
  double volume = 0, area = 0;
  void add(const Triangle& t) {
    area += t.area();
    volume += (t.a - origin).dot((t.b - origin).cross(t.c - origin)) / 6;
  }
  /// False for a sheet with two sides, which encloses nothing.
  [[nodiscard]] bool is_solid() const {
    constexpr double kThin = 1e-5;
    return std::abs(volume) > kThin * std::pow(area, 1.5);
  }
};

SurfacePieces find_pieces(const std::vector<Triangle>& triangles) {
  const CornerNumbers numbers = number_corners(triangles);
  const std::vector<int> pieces = number_pieces(numbers);
  SurfacePieces result;
  std::vector<PieceSize> sizes;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Triangle& t = triangles[i];
    const std::size_t piece = as_index(pieces[i]);
    if (piece == result.corners.size()) {
      result.corners.emplace_back().fill(t.a);
      sizes.push_back({t.a});
    }
    sizes[piece].add(t);
    PieceCorners& corners = result.corners[piece];
    for (const Vec3& corner : {t.a, t.b, t.c}) {
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        Vec3 &low = corners[as_index(2 * axis)], &high = corners[as_index(2 * axis + 1)];
        if (corner[axis] < low[axis]) low = corner;
        if (corner[axis] > high[axis]) high = corner;
      }
    }
  }
  result.are_solids = have_no_rim(numbers) && std::ranges::all_of(sizes, &PieceSize::is_solid);
  return result;
}

}  // namespace

std::shared_ptr<const SurfacePieces> PartsAccess::pieces(const Parts<Triangle>& surface) {
  const std::lock_guard lock(surface.mutex_);
  if (!surface.corners_) {
    surface.corners_ = std::make_shared<SurfacePieces>(find_pieces(surface.list_));
  }
  return std::static_pointer_cast<const SurfacePieces>(surface.corners_);
}

bool is_closed(std::span<const Triangle> surface) { return have_no_rim(number_corners(surface)); }

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
