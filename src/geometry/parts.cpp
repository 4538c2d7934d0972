// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/parts.h"

#include "geometry/point_grid.h"

#include <algorithm>

namespace mneme::internal {

void PartsAccess::replace(PointCloud& cloud, std::size_t first,
                          std::span<const CloudPoint> points) {
  const Parts<CloudPoint>& old = *cloud.parts;
  auto grid = [&] {
    const std::lock_guard lock(old.mutex_);
    return std::static_pointer_cast<PointGrid>(old.grid_);
  }();
  // Two hold the grid: the points and this function.
  const bool is_mine = cloud.parts.use_count() == 1 && grid.use_count() <= 2;
  if (is_mine) {
    // Letting go synchronizes with others who let go before, which use_count() does not.
    std::shared_ptr(cloud.parts).reset();
    std::shared_ptr(grid).reset();
  }
  // Made by whoever gave the points, always as an object that is not const.
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
