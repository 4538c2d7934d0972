// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "collision/crowd_tables.h"

#include "base/as_index.h"
#include "collision/make_tables.h"
#include "geometry/part_distance.h"
#include "robot/link_shapes.h"

#include <algorithm>
#include <cmath>

namespace mneme::internal {

namespace {

double farthest_slide(const Robot& robot, const Joint& joint) {
  if (joint.mimic) {
    const double followed = farthest_slide(robot, robot.joints()[as_index(joint.mimic->joint)]);
    return std::abs(joint.mimic->multiplier) * followed + std::abs(joint.mimic->offset);
  }
  return std::max({std::abs(joint.lower), std::abs(joint.upper), std::abs(joint.fixed_value)});
}

}  // namespace

double reach_of(const Robot& robot) {
  double most = 0;
  const auto carry = [&](int link, std::span<const Capsule> shapes) {
    const Sphere bound = bound_of(shapes);
    double reach = bound.center.norm() + bound.radius;
    for (int i = robot.links()[as_index(link)].parent_joint; i >= 0;) {
      const Joint& joint = robot.joints()[as_index(i)];
      reach += joint.origin.translation.norm();
      if (joint.type == JointType::prismatic) reach += farthest_slide(robot, joint);
      i = robot.links()[as_index(joint.parent_link)].parent_joint;
    }
    most = std::max(most, reach);
  };
  for (std::size_t i = 0; i < robot.links().size(); ++i) {
    if (has_shapes(robot.links()[i])) carry(static_cast<int>(i), shapes_of(robot.links()[i]));
  }
  for (const CoveredObject& held : robot.attached()) {
    const auto link = std::ranges::find(robot.links(), held.object.link, &Link::name);
    if (link == robot.links().end()) continue;
    Link shapes;
    shapes.spheres = held.spheres;
    shapes.capsules = held.capsules;
    carry(static_cast<int>(link - robot.links().begin()), shapes_of(shapes));
  }
  return most + kSpareReach;
}

namespace {

/// Rounded outwards.
Region region_of(const AxisBox& box) {
  Region region;
  for (int axis = 0; axis < 3; ++axis) {
    const double slack = 1e-6 * (1 + box.low.cwiseAbs().cwiseMax(box.high.cwiseAbs())[axis]);
    region.low[as_index(axis)] = static_cast<float>(box.low[axis] - slack);
    region.high[as_index(axis)] = static_cast<float>(box.high[axis] + slack);
  }
  return region;
}

bool contains(const Region& outer, const Region& inner) {
  return outer.contains(inner.low) && outer.contains(inner.high);
}

/// Of the parts' frame, what may touch something within `reach` of the scene's origin.
template <class Part>
Region region_of_interest(const Crowd<Part>& crowd, double reach) {
  const AxisBox all = PartsAccess::bounds(*crowd.parts);
  const Vec3 origin = crowd.pose.inverse().translation;
  const Vec3 half = Vec3::Constant(std::min(reach + crowd.radius, 1e6));
  AxisBox box = intersection(all, {origin - half, origin + half});
  if (box.is_empty()) box = {all.low, all.low};
  return region_of(box);
}

/// Points that are replaced may go a little farther; there are cells for them (kRim).
Region with_rim(Region region) {
  constexpr float kRimMetres = 0.05f;
  for (float& low : region.low) low -= kRimMetres;
  for (float& high : region.high) high += kRimMetres;
  return region;
}

/// From the scene's frame to that of the parts.
CrowdRow posed_row(const Transform& pose) {
  CrowdRow row;
  const Transform to_parts = pose.inverse();
  store(to_parts.rotation, row.rotation);
  store(to_parts.translation, row.translation);
  return row;
}

/// Leaves as blocks of parts, the last of which repeats.
template <class Part>
std::vector<Part> parts_of_leaf(const BoxTree& tree, const BoxTree::Node& leaf,
                                const std::vector<Part>& list) {
  std::vector<Part> parts;
  for (int i = 0; i < kPartsPerLeaf; ++i) {
    const int at = leaf.first + std::min(i, leaf.count - 1);
    parts.push_back(list[as_index(tree.order()[as_index(at)])]);
  }
  return parts;
}

void add_block(const std::vector<Triangle>& parts, PartTree& tree) {
  TriangleBlock block;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Triangle& t = parts[i];
    for (int axis = 0; axis < 3; ++axis) {
      block.a[axis][i] = static_cast<float>(t.a[axis]);
      block.to_b[axis][i] = static_cast<float>(t.b[axis] - t.a[axis]);
      block.to_c[axis][i] = static_cast<float>(t.c[axis] - t.a[axis]);
    }
  }
  tree.triangles.push_back(block);
}

void add_block(const std::vector<Cube>& parts, PartTree& tree) {
  CubeBlock block;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      block.center[axis][i] = static_cast<float>(parts[i].center[axis]);
    }
    block.half_extent[i] = static_cast<float>(parts[i].half_extent);
  }
  tree.cubes.push_back(block);
}

template <class Part>
void add_nodes(const std::vector<Part>& list, PartTree& result) {
  std::vector<AxisBox> boxes;
  boxes.reserve(list.size());
  for (const Part& part : list) boxes.push_back(box_of(part));
  const BoxTree tree(boxes, kPartsPerLeaf);
  for (const BoxTree::Node& node : tree.nodes()) {
    const Region box = region_of(node.box);
    PartNode& row = result.nodes.emplace_back();
    std::copy(box.low.begin(), box.low.end(), row.low);
    std::copy(box.high.begin(), box.high.end(), row.high);
    row.right = node.right;
    if (node.right >= 0) continue;
    row.leaf = static_cast<int>(std::max(result.triangles.size(), result.cubes.size()));
    add_block(parts_of_leaf(tree, node, list), result);
  }
}

bool fills_its_box(const Cube&) { return true; }
bool fills_its_box(const Triangle& t) {
  const Vec3 normal = (t.b - t.a).cross(t.c - t.a).cwiseAbs();
  return normal.maxCoeff() > (1 - 1e-6) * normal.sum();
}

/// Marks the cells that a part may run through.
template <class Part>
void mark(const Part& part, const CellGrid& grid, std::vector<std::uint8_t>& is_occupied) {
  const Region box = region_of(box_of(part));
  CellGrid::Index low = grid.cell_of(box.low), high = grid.cell_of(box.high);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] = std::max(low[axis], 0);
    high[axis] = std::min(high[axis], grid.count[axis] - 1);
  }
  const double half_diagonal = std::sqrt(0.75) * grid.cell * (1 + 1e-4);
  const bool is_full =
      fills_its_box(part) || (high[0] - low[0] < 2 && high[1] - low[1] < 2 && high[2] - low[2] < 2);
  for (int z = low[2]; z <= high[2]; ++z) {
    for (int y = low[1]; y <= high[1]; ++y) {
      for (int x = low[0]; x <= high[0]; ++x) {
        std::uint8_t& mark = is_occupied[grid.slot({x, y, z})];
        if (mark != 0) continue;
        const Vec3 origin(grid.origin[0], grid.origin[1], grid.origin[2]);
        const Vec3 center = origin + double{grid.cell} * Vec3(x + 0.5, y + 0.5, z + 0.5);
        mark = is_full || (center - nearest_on(center, part)).norm() <= half_diagonal ? 1 : 0;
      }
    }
  }
}

template <class Part>
PartTree make_part_tree(const std::vector<Part>& list, const Region& region) {
  PartTree tree;
  tree.region = region;
  tree.cells = make_cell_grid(region);
  std::vector<std::uint8_t> is_occupied(tree.cells.gaps.size(), 0);
  for (const Part& part : list) mark(part, tree.cells, is_occupied);
  find_gaps(is_occupied, tree.cells);
  add_nodes(list, tree);
  return tree;
}

template <class Part>
CrowdRow make_tree_row(const Crowd<Part>& crowd, double reach) {
  const Region region = region_of_interest(crowd, reach);
  const auto tree = PartsAccess::grid<PartTree>(
      *crowd.parts, [&](const PartTree& kept) { return contains(kept.region, region); },
      [&] { return make_part_tree(crowd.parts->list(), region); });
  CrowdRow row = posed_row(crowd.pose);
  row.cells = &tree->cells;
  row.tree = tree.get();
  row.owner = tree;
  return row;
}

}  // namespace

CrowdRow make_crowd_row(const PointCloud& crowd, double reach) {
  const Region region = region_of_interest(crowd, reach);
  const auto grid = PartsAccess::grid<PointGrid>(
      *crowd.parts, [&](const PointGrid& kept) { return contains(kept.region, region); },
      [&] { return make_point_grid(crowd.parts->list(), with_rim(region)); });
  CrowdRow row = posed_row(crowd.pose);
  row.cells = &grid->cells;
  row.points = grid.get();
  row.owner = grid;
  return row;
}

CrowdRow make_crowd_row(const Mesh& crowd, double reach) { return make_tree_row(crowd, reach); }
CrowdRow make_crowd_row(const Octree& crowd, double reach) { return make_tree_row(crowd, reach); }

}  // namespace mneme::internal
