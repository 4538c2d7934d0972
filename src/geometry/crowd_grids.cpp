// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/crowd_grids.h"

#include "base/as_index.h"
#include "geometry/part_distance.h"

#include <algorithm>
#include <cmath>

namespace mneme::internal {

Vec3 middle_of(const CellGrid& cells) {
  return {cells.middle[0], cells.middle[1], cells.middle[2]};
}

namespace {

/// Relative to `middle`, rounded outwards.
Region region_of(const AxisBox& box, const Vec3& middle) {
  Region region;
  const Vec3 low = box.low - middle, high = box.high - middle;
  for (int axis = 0; axis < 3; ++axis) {
    const double slack = 1e-6 * (1 + low.cwiseAbs().cwiseMax(high.cwiseAbs())[axis]);
    region.low[as_index(axis)] = static_cast<float>(low[axis] - slack);
    region.high[as_index(axis)] = static_cast<float>(high[axis] + slack);
  }
  return region;
}

bool contains(const Region& outer, const Region& inner) {
  return outer.contains(inner.low) && outer.contains(inner.high);
}

/// Points that are replaced may go a little farther; there are cells for them (kRim).
Region with_rim(Region region) {
  constexpr float kRimMetres = 0.05f;
  for (float& low : region.low) low -= kRimMetres;
  for (float& high : region.high) high += kRimMetres;
  return region;
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
  const Vec3 middle = middle_of(tree.cells);
  TriangleBlock block;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Triangle& t = parts[i];
    for (int axis = 0; axis < 3; ++axis) {
      block.a[axis][i] = static_cast<float>(t.a[axis] - middle[axis]);
      block.to_b[axis][i] = static_cast<float>(t.b[axis] - t.a[axis]);
      block.to_c[axis][i] = static_cast<float>(t.c[axis] - t.a[axis]);
    }
  }
  tree.triangles.push_back(block);
}

void add_block(const std::vector<Cube>& parts, PartTree& tree) {
  const Vec3 middle = middle_of(tree.cells);
  CubeBlock block;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      block.center[axis][i] = static_cast<float>(parts[i].center[axis] - middle[axis]);
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
    const Region box = region_of(node.box, middle_of(result.cells));
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

/// Of a cube of the grid, so many times smaller than a cell.
Vec3 center_of(const CellGrid::Index& i, int per_cell, const CellGrid& grid) {
  const Vec3 origin = middle_of(grid) + Vec3(grid.origin[0], grid.origin[1], grid.origin[2]);
  return origin + double{grid.cell} / per_cell * Vec3(i[0] + 0.5, i[1] + 0.5, i[2] + 0.5);
}

/// Calls `visit(index)` for all from `low` to `high`.
template <class Visit>
void visit_range(const CellGrid::Index& low, const CellGrid::Index& high, const Visit& visit) {
  for (int z = low[2]; z <= high[2]; ++z) {
    for (int y = low[1]; y <= high[1]; ++y) {
      for (int x = low[0]; x <= high[0]; ++x) visit(CellGrid::Index{x, y, z});
    }
  }
}

/// Marks the octants that a part may run through.
template <class Part>
void mark(const Part& part, CellGrid& grid) {
  const Region box = region_of(box_of(part), middle_of(grid));
  CellGrid::Index low = grid.octant_of(box.low), high = grid.octant_of(box.high);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] = std::max(low[axis], 0);
    high[axis] = std::min(high[axis], 2 * grid.count[axis] - 1);
    if (low[axis] > high[axis]) return;
  }
  const bool is_full =
      fills_its_box(part) || (high[0] - low[0] < 2 && high[1] - low[1] < 2 && high[2] - low[2] < 2);
  const auto is_near = [&](const CellGrid::Index& i, int per_cell) {
    const double half_diagonal = std::sqrt(0.75) * grid.cell / per_cell * (1 + 1e-4);
    const Vec3 center = center_of(i, per_cell, grid);
    return is_full || (center - nearest_on(center, part)).norm() <= half_diagonal;
  };
  const auto half = [](const CellGrid::Index& i) {
    return CellGrid::Index{i[0] / 2, i[1] / 2, i[2] / 2};
  };
  visit_range(half(low), half(high), [&](const CellGrid::Index& cell) {
    std::uint8_t& octants = grid.octants[grid.slot(cell)];
    if (octants == 0xff || !is_near(cell, 1)) return;
    CellGrid::Index first, last;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      first[axis] = std::max(low[axis], 2 * cell[axis]);
      last[axis] = std::min(high[axis], 2 * cell[axis] + 1);
    }
    visit_range(first, last, [&](const CellGrid::Index& octant) {
      const std::uint8_t bit = CellGrid::bit_of(octant);
      if ((octants & bit) == 0 && is_near(octant, 2)) octants |= bit;
    });
  });
}

template <class Part>
PartTree make_part_tree(const std::vector<Part>& list, const Region& region, const Middle& middle) {
  PartTree tree{make_cell_grid(region, middle), region, {}, {}, {}};
  for (const Part& part : list) mark(part, tree.cells);
  find_gaps(tree.cells);
  add_nodes(list, tree);
  return tree;
}

template <class Grid, class Part, class Make>
std::shared_ptr<const Grid> share(const Parts<Part>& parts, const AxisBox& box, const Make& make) {
  const auto is_good = [&](const Grid& kept) {
    return contains(kept.region, region_of(box, middle_of(kept.cells)));
  };
  return PartsAccess::grid<Grid>(parts, is_good, [&] {
    const Vec3 middle = 0.5 * (box.low + box.high);
    return make(parts.list(), region_of(box, middle), {middle.x(), middle.y(), middle.z()});
  });
}

}  // namespace

std::shared_ptr<const PointGrid> share_grid(const Parts<CloudPoint>& parts, const AxisBox& box) {
  return share<PointGrid>(parts, box,
                          [](const auto& points, const Region& region, const Middle& middle) {
                            return make_point_grid(points, with_rim(region), middle);
                          });
}

std::shared_ptr<const PartTree> share_grid(const Parts<Triangle>& parts, const AxisBox& box) {
  return share<PartTree>(parts, box, make_part_tree<Triangle>);
}

std::shared_ptr<const PartTree> share_grid(const Parts<Cube>& parts, const AxisBox& box) {
  return share<PartTree>(parts, box, make_part_tree<Cube>);
}

}  // namespace mneme::internal
