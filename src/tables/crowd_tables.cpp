// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tables/crowd_tables.h"

#include "tables/make_tables.h"
#include "geometry/crowd_grids.h"
#include "geometry/parts.h"
#include "robot/link_shapes.h"

#include <algorithm>

namespace mneme::internal {

double reach_of(const Robot& robot) { return farthest_reach(robot) + kSpareReach; }

namespace {

/// Of the parts' frame, what may touch something within `reach` of the scene's origin.
template <class Part>
AxisBox region_of_interest(const Crowd<Part>& crowd, double reach) {
  const AxisBox all = PartsAccess::bounds(*crowd.parts);
  const Vec3 origin = crowd.pose.inverse().translation;
  const Vec3 half = Vec3::Constant(std::min(reach + crowd.radius, 1e6));
  const AxisBox box = intersection(all, {origin - half, origin + half});
  return box.is_empty() ? AxisBox{all.low, all.low} : box;
}

void set(const PointGrid& grid, CrowdRow& row) { row.points = &grid; }
void set(const PartTree& tree, CrowdRow& row) { row.tree = &tree; }

template <class Part>
CrowdRow make_row(const Crowd<Part>& crowd, double reach) {
  const auto grid = share_grid(*crowd.parts, region_of_interest(crowd, reach));
  const Transform to_parts = crowd.pose.inverse();
  CrowdRow row;
  row.cells = &grid->cells;
  row.owner = grid;
  set(*grid, row);
  store(to_parts.rotation, row.rotation);
  store(Vec3(to_parts.translation - middle_of(grid->cells)), row.translation);
  return row;
}

}  // namespace

CrowdRow make_crowd_row(const PointCloud& crowd, double reach) { return make_row(crowd, reach); }
CrowdRow make_crowd_row(const Mesh& crowd, double reach) { return make_row(crowd, reach); }
CrowdRow make_crowd_row(const Octree& crowd, double reach) { return make_row(crowd, reach); }

}  // namespace mneme::internal
