// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tables/compound_tables.h"

#include "tables/make_tables.h"
#include "geometry/compound_grids.h"
#include "geometry/parts.h"
#include "robot/link_shapes.h"

#include <algorithm>

namespace mneme::internal {

double reach_of(const Robot& robot) { return farthest_reach(robot) + kSpareReach; }

namespace {

/// Of the parts' frame, what may touch something within `reach` of the scene's origin.
template <class Part>
AxisBox region_of_interest(const CompoundShape<Part>& compound, double reach) {
  const AxisBox all = PartsAccess::bounds(*compound.parts);
  const Vec3 origin = compound.pose.inverse().translation;
  const Vec3 half = Vec3::Constant(std::min(reach + compound.radius, 1e6));
  const AxisBox box = intersection(all, {origin - half, origin + half});
  return box.is_empty() ? AxisBox{all.low, all.low} : box;
}

void set(const PointGrid& grid, CompoundRow& row) { row.points = &grid; }
void set(const PartTree& tree, CompoundRow& row) { row.tree = &tree; }

template <class Part>
CompoundRow make_row(const CompoundShape<Part>& compound, double reach) {
  const auto grid = share_grid(*compound.parts, region_of_interest(compound, reach));
  const Transform to_parts = compound.pose.inverse();
  CompoundRow row;
  row.voxels = &grid->voxels;
  row.owner = grid;
  set(*grid, row);
  store(to_parts.rotation, row.rotation);
  store(Vec3(to_parts.translation - middle_of(grid->voxels)), row.translation);
  return row;
}

}  // namespace

CompoundRow make_compound_row(const PointCloud& compound, double reach) {
  return make_row(compound, reach);
}
CompoundRow make_compound_row(const Mesh& compound, double reach) {
  return make_row(compound, reach);
}
CompoundRow make_compound_row(const Octree& compound, double reach) {
  return make_row(compound, reach);
}

}  // namespace mneme::internal
