// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/moveit_problem.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

namespace mneme::internal {
namespace {

/// Metres: beyond any robot's reach.
constexpr double kAnywhere = 1e3;
/// Factor on a cone, so that rotation vectors within it keep their tolerance, for any turn.
constexpr double kRotationVectorShare = 2 / std::numbers::pi;

std::optional<Input> only_constraint(const Input& goal, std::string_view key) {
  const std::vector<Input> constraints = goal.items(key);
  if (constraints.size() > 1) {
    goal.at(key).fail(ErrorCode::unsupported, "expected at most one of {} in a goal, got {}", key,
                      constraints.size());
  }
  return constraints.empty() ? std::nullopt : std::optional(constraints.front());
}

/// A box of positions, centred at its pose.
struct Region {
  Transform X_RB;
  Vec3 half_extents;
  bool is_cube = false;  ///< in a sphere: any orientation will do
};

Region read_region(const Input& constraint, const Transform& X_RF) {
  const Input region = constraint.at("constraint_region");
  region.allow_keys({"primitives", "primitive_poses", "meshes", "mesh_poses"});
  const std::vector<Input> primitives = region.items("primitives");
  const std::vector<Input> poses = region.items("primitive_poses");
  if (primitives.size() != 1 || poses.size() != 1 || !region.items("meshes").empty()) {
    region.fail(ErrorCode::unsupported,
                "expected a region of one primitive and its pose, got {} primitives, {} "
                "poses and {} meshes",
                primitives.size(), poses.size(), region.items("meshes").size());
  }
  const Transform X_RB = X_RF * read_moveit_pose(poses.front());
  const Shape shape = read_moveit_primitive(primitives.front(), X_RB, "the region");
  if (const auto* box = std::get_if<Box>(&shape)) return {X_RB, box->half_extents};
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    return {X_RB, Vec3::Constant(sphere->radius / std::sqrt(3.0)), true};
  }
  primitives.front().at("type").fail(ErrorCode::unsupported,
                                     "expected a box or a sphere as the region of a position");
}

void read_position(const Input& constraint, const Transform& X_RF, PoseGoal& goal) {
  constraint.allow_keys(
      {"header", "link_name", "target_point_offset", "constraint_region", "weight"});
  if (const auto offset = constraint.find_value("target_point_offset")) {
    const bool is_zero = std::ranges::all_of(
        offset->entries(), [](const auto& entry) { return entry.second.finite_number() == 0; });
    if (!is_zero) {
      offset->fail(ErrorCode::unsupported,
                   "expected no target_point_offset, because the region is for the link's origin");
    }
  }
  const Region region = read_region(constraint, X_RF);
  goal.pose.translation = region.X_RB.translation;
  const Eigen::Matrix3d turned = goal.pose.rotation.transpose() * region.X_RB.rotation;
  const Eigen::Matrix3d rounded = turned.array().round();
  if (region.is_cube) {
    goal.position_tolerance = region.half_extents;
  } else if (turned.isApprox(rounded, 1e-6)) {
    goal.position_tolerance = rounded.cwiseAbs() * region.half_extents;
  } else {
    goal.position_tolerance = Vec3::Constant(region.half_extents.minCoeff() / std::sqrt(3.0));
  }
}

/// For Euler angles x, y, z with the free turn about y: it enlarges the lean in the two others, and
/// flips them beyond a quarter turn.
void narrow_about_middle_axis(PoseGoal& goal) {
  constexpr double kWidest = 1.4;
  goal.turn = std::min(goal.turn, kWidest);
  goal.cone = std::atan(std::tan(std::min(goal.cone, kWidest)) * std::cos(goal.turn));
}

/// Tolerances about x, y and z, radians, at most pi.
std::array<double, 3> read_tolerances(const Input& constraint) {
  std::array<double, 3> tolerance = {};
  for (int i = 0; i < 3; ++i) {
    const std::string key = fmt::format("absolute_{}_axis_tolerance", "xyz"[i]);
    const auto given = constraint.find(key);
    if (!given) continue;
    const double value = given->taking_angles().finite_number();
    if (value < 0) given->fail_expecting("a tolerance of 0 or more");
    tolerance[static_cast<std::size_t>(i)] = std::min(value, std::numbers::pi);
  }
  return tolerance;
}

void read_orientation(const Input& constraint, const Transform& X_RF, PoseGoal& goal) {
  constraint.allow_keys({"header", "orientation", "link_name", "absolute_x_axis_tolerance",
                         "absolute_y_axis_tolerance", "absolute_z_axis_tolerance",
                         "parameterization", "weight"});
  goal.pose.rotation = X_RF.rotation * read_moveit_rotation(constraint.at("orientation"));
  const std::array<double, 3> tolerance = read_tolerances(constraint);
  const auto widest = std::ranges::max_element(tolerance) - tolerance.begin();
  goal.axis = static_cast<Axis>(widest);
  goal.turn = tolerance[static_cast<std::size_t>(widest)];
  goal.cone = std::min(tolerance[static_cast<std::size_t>((widest + 1) % 3)],
                       tolerance[static_cast<std::size_t>((widest + 2) % 3)]);
  const auto vector = constraint.find_value("parameterization");
  const bool is_vector = vector && vector->number() == 1;
  if (is_vector) goal.cone *= kRotationVectorShare;
  if (!is_vector && goal.axis == Axis::y) narrow_about_middle_axis(goal);
  // A lean changes the angle about the axis slightly.
  if (goal.turn < std::numbers::pi)
    goal.turn = std::max(0.0, goal.turn - goal.cone * goal.cone / 2);
}

}  // namespace

bool is_moveit_pose_goal(const Input& goal) {
  return !goal.items("position_constraints").empty() ||
         !goal.items("orientation_constraints").empty();
}

PoseGoal read_moveit_pose_goal(const Input& goal, const FrameOf& frame_of) {
  const auto position = only_constraint(goal, "position_constraints");
  const auto orientation = only_constraint(goal, "orientation_constraints");
  PoseGoal result;
  result.position_tolerance = Vec3::Constant(kAnywhere);
  result.cone = result.turn = std::numbers::pi;
  if (orientation) {
    result.link = orientation->at("link_name").text();
    read_orientation(*orientation, frame_of(*orientation), result);
  }
  if (position) {
    const Input link = position->at("link_name");
    if (orientation && link.text() != result.link) {
      link.fail(ErrorCode::unsupported,
                "expected the link of the orientation constraint, {}, got {}", result.link,
                link.text());
    }
    result.link = link.text();
    read_position(*position, frame_of(*position), result);
  }
  return result;
}

OrientationConstraint read_moveit_path_constraint(const Input& constraint,
                                                  const FrameOf& frame_of) {
  PoseGoal region;
  read_orientation(constraint, frame_of(constraint), region);
  if (region.turn < std::numbers::pi) {
    constraint.fail(ErrorCode::unsupported,
                    "expected a path constraint with a tolerance of pi about one axis, "
                    "got {:.5g}",
                    fmt::join(read_tolerances(constraint), ", "));
  }
  OrientationConstraint result;
  result.link = constraint.at("link_name").text();
  result.axis = Vec3::Unit(static_cast<int>(region.axis));
  result.up = region.pose.rotation * result.axis;
  result.angle = region.cone;
  return result;
}

}  // namespace mneme::internal
