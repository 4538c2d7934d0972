// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/compound_grids.h"

#include "base/as_index.h"
#include "base/threads.h"
#include "geometry/part_distance.h"
#include "geometry/parts.h"

#include <algorithm>
#include <cmath>

namespace mneme::internal {

Vec3 middle_of(const VoxelGrid& voxels) {
  return {voxels.middle[0], voxels.middle[1], voxels.middle[2]};
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

/// Room for points that replace others: within the rim of voxels (kRim).
Region with_rim(Region region) {
  constexpr float kRimMetres = 0.05f;
  for (float& low : region.low) low -= kRimMetres;
  for (float& high : region.high) high += kRimMetres;
  return region;
}

/// The parts of a leaf; the last one is repeated to fill the block.
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

/// The normal for single precision, zero for slivers with an angle of up to 1e-5. Their edges
/// replace them, with an error below 5e-6 of their length. For a length of 1 m this is a tenth of
/// the margin that verification keeps.
Vec3 single_normal_of(const Triangle& t) { return normal_of(t, 1e-10); }

void add_block(const std::vector<Triangle>& parts, PartTree& tree) {
  const Vec3 middle = middle_of(tree.voxels);
  TriangleBlock block;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Triangle& t = parts[i];
    const Vec3 normal = single_normal_of(t);
    for (int axis = 0; axis < 3; ++axis) {
      block.a[axis][i] = static_cast<float>(t.a[axis] - middle[axis]);
      block.to_b[axis][i] = static_cast<float>(t.b[axis] - t.a[axis]);
      block.to_c[axis][i] = static_cast<float>(t.c[axis] - t.a[axis]);
      block.normal[axis][i] = static_cast<float>(normal[axis]);
    }
  }
  tree.triangles.push_back(block);
}

void add_block(const std::vector<Cube>& parts, PartTree& tree) {
  const Vec3 middle = middle_of(tree.voxels);
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
  const BoxTree tree(boxes_of(list), kPartsPerLeaf);
  for (const BoxTree::Node& node : tree.nodes()) {
    poll_interrupt();
    const Region box = region_of(node.box, middle_of(result.voxels));
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
  const Vec3 normal = single_normal_of(t).cwiseAbs();
  return normal.maxCoeff() > (1 - 1e-6) * normal.sum();
}

/// True if a cube of half the edge `half` surely lies on one side of the part's plane.
bool is_beside(const Triangle& t, const Vec3& center, double half) {
  const Vec3 normal = single_normal_of(t);
  return std::abs(normal.dot(center - t.a)) > half * normal.lpNorm<1>();
}
bool is_beside(const Cube&, const Vec3&, double) { return false; }

/// Calls `visit(index)` for all indices from `low` to `high`.
template <class Visit>
void visit_range(const VoxelGrid::Index& low, const VoxelGrid::Index& high, const Visit& visit) {
  for (int z = low[2]; z <= high[2]; ++z) {
    for (int y = low[1]; y <= high[1]; ++y) {
      for (int x = low[0]; x <= high[0]; ++x) visit(VoxelGrid::Index{x, y, z});
    }
  }
}

/// Marks the octants that a part may intersect. Descends from cubes of 2^level octants per axis to
/// the eighths of cubes near the part.
template <class Part>
class Marker {
 public:
  Marker(const Part& part, VoxelGrid& grid)
      : part_(part),
        grid_(grid),
        origin_(middle_of(grid) + Vec3(grid.origin[0], grid.origin[1], grid.origin[2])) {
    const Region box = region_of(box_of(part), middle_of(grid));
    low_ = grid.octant_of(box.low);
    high_ = grid.octant_of(box.high);
  }

  void mark() {
    int longest = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low_[axis] = std::max(low_[axis], 0);
      high_[axis] = std::min(high_[axis], 2 * grid_.count[axis] - 1);
      if (low_[axis] > high_[axis]) return;
      longest = std::max(longest, high_[axis] - low_[axis]);
    }
    is_full_ = longest < 2 || fills_its_box(part_);
    int level = kVoxelLevel;
    while (longest >> level != 0) ++level;
    visit_range(shifted(low_, level), shifted(high_, level),
                [&](const VoxelGrid::Index& cube) { mark(cube, level); });
  }

 private:
  static constexpr int kVoxelLevel = 1;

  static VoxelGrid::Index shifted(const VoxelGrid::Index& octant, int level) {
    return {octant[0] >> level, octant[1] >> level, octant[2] >> level};
  }

  void mark(const VoxelGrid::Index& cube, int level) {
    if (is_marked(cube, level) || !is_near(cube, level)) return;
    if (level == 0) {
      grid_.octants[grid_.slot_of(cube)] |= VoxelGrid::bit_of(cube);
      return;
    }
    VoxelGrid::Index first, last;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      first[axis] = std::max(low_[axis] >> (level - 1), 2 * cube[axis]);
      last[axis] = std::min(high_[axis] >> (level - 1), 2 * cube[axis] + 1);
    }
    visit_range(first, last, [&](const VoxelGrid::Index& eighth) { mark(eighth, level - 1); });
  }

  /// True if all octants of the cube are marked.
  [[nodiscard]] bool is_marked(const VoxelGrid::Index& cube, int level) const {
    if (level > kVoxelLevel) return false;
    if (level == kVoxelLevel) return grid_.octants[grid_.slot(cube)] == 0xff;
    return (grid_.octants[grid_.slot_of(cube)] & VoxelGrid::bit_of(cube)) != 0;
  }

  [[nodiscard]] bool is_near(const VoxelGrid::Index& cube, int level) const {
    if (is_full_) return true;
    const double half = 0.25 * grid_.edge * (1 << level);
    const Vec3 center = origin_ + half * Vec3(2 * cube[0] + 1, 2 * cube[1] + 1, 2 * cube[2] + 1);
    const double slack = half * (1 + 1e-4);
    return !is_beside(part_, center, slack) &&
           (center - nearest_on(center, part_)).squaredNorm() <= 3 * slack * slack;
  }

  const Part& part_;
  VoxelGrid& grid_;
  Vec3 origin_;                      ///< of the parts' frame
  VoxelGrid::Index low_{}, high_{};  ///< octants of the part's box
  bool is_full_ = false;             ///< the part fills its box, or nearly so
};

template <class Part>
PartTree make_part_tree(const std::vector<Part>& list, const Region& region, const Middle& middle) {
  PartTree tree{make_voxel_grid(region, middle), region, {}, {}, {}};
  for (const Part& part : list) {
    poll_interrupt();
    Marker<Part>(part, tree.voxels).mark();
  }
  find_clearances(tree.voxels);
  add_nodes(list, tree);
  return tree;
}

template <class Grid, class Part, class Make>
std::shared_ptr<const Grid> share(const Parts<Part>& parts, const AxisBox& box, const Make& make) {
  const auto is_good = [&](const Grid& kept) {
    return contains(kept.region, region_of(box, middle_of(kept.voxels)));
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
