// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/as_index.h"
#include "tables/make_tables.h"
#include "geometry/parts.h"
#include "geometry/solids.h"
#include "scene/scene_input.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

namespace mneme::internal {
namespace {

/// Largest distance of parts from the origin of their frame, metres: doubles resolve 2e-9 m there.
/// Points are floats, which resolve a millimetre at kFarthestShape.
constexpr double kFarthestPart = 1e7;
/// Largest entry of a rotation that counts as 0: below the resolution of floats.
constexpr double kAligned = 1e-7;
/// Number of boxes whose axes are tried for the scene's frame.
constexpr int kMaxTrials = 16;

/// Says what of a shape is too far away; empty if nothing is.
std::string_view find_far(const Shape& shape) {
  const Sphere bound = bounding_sphere(shape);
  if (!(bound.center.norm() + bound.radius <= kFarthestShape)) return "extends beyond 10 km";
  const auto farthest = [](const auto& s) -> double {
    if constexpr (requires { s.parts; }) {
      const AxisBox box = PartsAccess::bounds(*s.parts);
      return box.low.cwiseAbs().cwiseMax(box.high.cwiseAbs()).maxCoeff();
    }
    return 0;
  };
  const double away = std::visit(farthest, shape);
  if (std::holds_alternative<PointCloud>(shape)) {
    return away <= kFarthestShape ? "" : "has points beyond 10 km in their own frame";
  }
  return away <= kFarthestPart ? "" : "has parts beyond 10000 km in their own frame";
}

Result<void> check(const Obstacle& obstacle) {
  if (obstacle.shapes.empty()) {
    return fail(ErrorCode::invalid, "obstacle '" + obstacle.name + "' has no shapes");
  }
  MNEME_TRY(check_shapes(obstacle));
  for (const Shape& shape : obstacle.shapes) {
    const std::string_view far = find_far(shape);
    if (far.empty()) continue;
    return fail(ErrorCode::invalid, "obstacle '" + obstacle.name + "': " + said_of(shape, far));
  }
  return {};
}

/// True if each axis of `rotation` is a coordinate axis or the opposite of one.
bool is_permutation(const Eigen::Matrix3d& rotation) {
  return ((rotation.array().abs() < kAligned) || (rotation.array().abs() > 1 - kAligned)).all();
}

/// Rotation from the root to a frame with the axes of most boxes.
Eigen::Matrix3d choose_axes(const Scene& scene) {
  std::vector<Eigen::Matrix3d> boxes;
  for (const Obstacle& obstacle : scene.obstacles) {
    for (const Shape& shape : obstacle.shapes) {
      if (const auto* box = std::get_if<Box>(&shape)) boxes.push_back(box->pose.rotation);
    }
  }
  const auto count_aligned = [&](const Eigen::Matrix3d& axes) {
    return std::ranges::count_if(boxes, [&](const Eigen::Matrix3d& rotation) {
      return is_permutation(axes.transpose() * rotation);
    });
  };
  // The robot's own axes cost least and win ties.
  Eigen::Matrix3d best = Eigen::Matrix3d::Identity();
  auto most = count_aligned(best);
  const std::size_t trials = std::min(boxes.size(), std::size_t{kMaxTrials});
  for (std::size_t i = 0; i < trials && 2 * most < std::ssize(boxes); ++i) {
    const auto count = count_aligned(boxes[i]);
    if (count <= most) continue;
    most = count;
    best = boxes[i];
  }
  return best.transpose();
}

void set_grid(const PointGrid& grid, CompoundRow& row) { row.points = &grid; }
void set_grid(const PartTree& tree, CompoundRow& row) { row.tree = &tree; }

/// `compound` is in the scene's frame. Its grid is cached with the parts.
template <class Part>
CompoundRow make_compound_row(const CompoundShape<Part>& compound, double reach) {
  const auto grid = share_grid(*compound.parts, region_of_interest(compound, reach));
  const Transform to_parts = compound.pose.inverse();
  CompoundRow row;
  row.voxels = &grid->voxels;
  row.owner = grid;
  set_grid(*grid, row);
  store(to_parts.rotation, row.rotation);
  store(Vec3(to_parts.translation - middle_of(grid->voxels)), row.translation);
  return row;
}

/// A shape's row, and its bounding box by centre and half extents.
struct Placed {
  ObstacleRow row;
  Vec3 center = Vec3::Zero();
  Vec3 reach = Vec3::Zero();
  std::optional<CompoundRow> compound = {};
};

/// Expects shapes in the scene's frame.
struct Place {
  double reach_of_interest = 0;

  Placed operator()(const Sphere& s) const {
    Placed result{{}, s.center, Vec3::Constant(s.radius)};
    result.row.kind = ObstacleKind::sphere;
    result.row.rounding = static_cast<float>(s.radius);
    store(s.center, result.row.center);
    return result;
  }

  Placed operator()(const Capsule& s) const {
    Placed result{{}, (s.a + s.b) / 2, Vec3::Constant(s.radius) + (s.b - s.a).cwiseAbs() / 2};
    result.row.kind = ObstacleKind::capsule;
    result.row.rounding = static_cast<float>(s.radius);
    store(s.a, result.row.center);
    store(Vec3(s.b - s.a), result.row.along);
    const double length2 = (s.b - s.a).squaredNorm();
    result.row.inverse_length2 = length2 < 1e-18 ? 0.0f : static_cast<float>(1 / length2);
    return result;
  }

  Placed operator()(const Box& s) const {
    const Eigen::Matrix3d& rotation = s.pose.rotation;
    Placed result{{}, s.pose.translation, rotation.cwiseAbs() * s.half_extents};
    const bool is_aligned = is_permutation(rotation);
    result.row.kind = is_aligned ? ObstacleKind::aligned_box : ObstacleKind::box;
    store(result.center, result.row.center);
    store(Eigen::Matrix3d(rotation.transpose()), result.row.rotation);
    store(is_aligned ? result.reach : s.half_extents, result.row.half_extents);
    return result;
  }

  Placed operator()(const Cylinder& s) const {
    const Vec3 axis = s.pose.rotation.col(2);
    const Vec3 across = (1 - axis.array().square()).max(0).sqrt();
    Placed result{{}, s.pose.translation, s.radius * across + s.length / 2 * axis.cwiseAbs()};
    const bool is_upright = axis.head<2>().cwiseAbs().maxCoeff() < kAligned;
    result.row.kind = is_upright ? ObstacleKind::upright_cylinder : ObstacleKind::cylinder;
    store(result.center, result.row.center);
    store(Eigen::Matrix3d(s.pose.rotation.transpose()), result.row.rotation);
    store(Vec3(s.radius, s.radius, s.length / 2), result.row.half_extents);
    return result;
  }

  template <class Part>
  Placed operator()(const CompoundShape<Part>& s) const {
    const AxisBox box = PartsAccess::bounds(*s.parts);
    const Eigen::Matrix3d& rotation = s.pose.rotation;
    Placed result{{},
                  s.pose * Vec3(0.5 * (box.low + box.high)),
                  rotation.cwiseAbs() * (0.5 * (box.high - box.low)) + Vec3::Constant(s.radius),
                  make_compound_row(s, reach_of_interest)};
    result.row.kind = ObstacleKind::compound;
    result.row.rounding = static_cast<float>(s.radius);
    store(result.center, result.row.center);
    return result;
  }
};

void add(const Placed& placed, SceneTables& tables) {
  tables.obstacles.push_back(placed.row);
  if (placed.compound) {
    tables.obstacles.back().compound = static_cast<int>(tables.compounds.size());
    tables.compounds.push_back(*placed.compound);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = as_index(axis);
    // Rounding to float must not shrink the box.
    const double reach =
        placed.reach[axis] + 1e-6 * (1 + std::abs(placed.center[axis]) + placed.reach[axis]);
    tables.lower[i].push_back(static_cast<float>(placed.center[axis] - reach));
    tables.upper[i].push_back(static_cast<float>(placed.center[axis] + reach));
  }
}

}  // namespace

Result<SceneTables> make_scene_tables(const Scene& scene, double reach) {
  for (const Obstacle& obstacle : scene.obstacles) MNEME_TRY(check(obstacle));
  assert(reach >= 0);
  SceneTables tables;
  const Transform X_SW{choose_axes(scene), Vec3::Zero()};
  store(X_SW.rotation, tables.rotation);
  for (const Obstacle& obstacle : scene.obstacles) {
    for (const Shape& shape : obstacle.shapes) {
      add(std::visit(Place{reach}, transformed(X_SW, shape)), tables);
    }
  }
  const std::size_t blocks = (tables.obstacles.size() + kObstacleBlock - 1) / kObstacleBlock;
  for (auto& bounds : tables.lower) {
    bounds.resize(blocks * kObstacleBlock, std::numeric_limits<float>::infinity());
  }
  for (auto& bounds : tables.upper) {
    bounds.resize(blocks * kObstacleBlock, -std::numeric_limits<float>::infinity());
  }
  return tables;
}

std::vector<std::uint16_t> find_allowed_contacts(const Robot& robot, const RobotTables& tables,
                                                 const Scene& scene) {
  std::vector<std::uint16_t> bits;
  std::size_t shape_count = 0;
  for (const Obstacle& obstacle : scene.obstacles) shape_count += obstacle.shapes.size();
  const std::size_t words = (shape_count + kObstacleBlock - 1) / kObstacleBlock;
  std::size_t first = 0;
  for (const Obstacle& obstacle : scene.obstacles) {
    NamedLinks named = find_named_links(robot, obstacle);
    std::vector<int>& links = named.may_touch;
    links.insert(links.end(), named.exact_links.begin(), named.exact_links.end());
    if (!links.empty()) bits.resize(words * tables.groups.size());
    for (std::size_t group = 0; group < tables.groups.size() && !links.empty(); ++group) {
      if (std::ranges::find(links, tables.link_of_group[group]) == links.end()) continue;
      for (std::size_t i = first; i < first + obstacle.shapes.size(); ++i) {
        bits[group * words + i / kObstacleBlock] |=
            static_cast<std::uint16_t>(1u << i % kObstacleBlock);
      }
    }
    first += obstacle.shapes.size();
  }
  return bits;
}

}  // namespace mneme::internal
