// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "collision/make_tables.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "collision/collision_kernels.h"

namespace mneme::internal {
namespace {

void store(const Vec3& v, float* out) {
  for (int i = 0; i < 3; ++i) out[i] = static_cast<float>(v[i]);
}

void store(const Eigen::Matrix3d& m, float* out) {
  for (int i = 0; i < 9; ++i) out[i] = static_cast<float>(m(i / 3, i % 3));
}

/// A rotation that takes the z axis to the unit vector `axis`.
Eigen::Matrix3d rotation_to_axis(const Vec3& axis) {
  const Vec3 z = Vec3::UnitZ();
  const Vec3 turn = z.cross(axis);
  const double sine = turn.norm(), cosine = z.dot(axis);
  if (sine > 1e-12) return rotation_about(turn / sine, std::atan2(sine, cosine));
  if (cosine > 0) return Eigen::Matrix3d::Identity();
  return rotation_about(Vec3::UnitX(), M_PI);
}

/// Where a link's coordinates are expressed: a frame, and the link's pose in it.
struct Placement {
  int frame = -1;
  Transform X_frame_link;
};

class RobotTablesBuilder {
 public:
  explicit RobotTablesBuilder(const Robot& robot) : robot_(robot) {
    tables_.joint_count = robot.joint_count();
    for (int i = 0; i < robot.joint_count(); ++i) {
      group_index_[robot.group()[static_cast<std::size_t>(i)]] = i;
    }
  }

  RobotTables build() {
    placements_.resize(robot_.links().size());
    std::vector<int> row_of_link(robot_.links().size(), -1);
    for (std::size_t i = 0; i < robot_.links().size(); ++i) {
      const Link& link = robot_.links()[i];
      if (link.parent_joint >= 0) place(static_cast<int>(i));
      if (!link.spheres.empty() || !link.capsules.empty()) add_shapes(static_cast<int>(i));
    }
    std::reverse(tables_.links.begin(), tables_.links.end());
    for (std::size_t i = 0; i < tables_.links.size(); ++i) {
      row_of_link[static_cast<std::size_t>(tables_.links[i].link)] = static_cast<int>(i);
    }
    for (std::size_t i = 0; i < tables_.fixed_links.size(); ++i) {
      row_of_link[static_cast<std::size_t>(tables_.fixed_links[i].link)] = static_cast<int>(i);
    }
    for (const auto& [a, b] : robot_.self_pairs()) add_pair(a, b, row_of_link);
    return std::move(tables_);
  }

 private:
  void place(int link_index) {
    const int joint_index = robot_.links()[static_cast<std::size_t>(link_index)].parent_joint;
    const Joint& joint = robot_.joints()[static_cast<std::size_t>(joint_index)];
    const Placement& parent = placements_[static_cast<std::size_t>(joint.parent_link)];
    const Transform X_frame_joint = parent.X_frame_link * joint.origin;
    Placement& placement = placements_[static_cast<std::size_t>(link_index)];
    const auto in_group = group_index_.find(joint_index);
    if (in_group == group_index_.end()) {
      placement = {parent.frame, X_frame_joint * fixed_motion(joint)};
      return;
    }
    const Eigen::Matrix3d to_axis = rotation_to_axis(joint.axis);
    const Eigen::Matrix3d rotation = X_frame_joint.rotation * to_axis;
    FrameRow row;
    row.parent = parent.frame;
    row.joint = in_group->second;
    row.is_prismatic = joint.type == JointType::prismatic;
    row.is_rotated = !rotation.isApprox(Eigen::Matrix3d::Identity(), 1e-12);
    store(rotation, row.rotation);
    store(X_frame_joint.translation, row.translation);
    tables_.frames.push_back(row);
    placement.frame = static_cast<int>(tables_.frames.size()) - 1;
    placement.X_frame_link = {to_axis.transpose(), Vec3::Zero()};
  }

  static Transform fixed_motion(const Joint& joint) {
    if (joint.type == JointType::fixed) return {};
    if (joint.type == JointType::prismatic) {
      return {Eigen::Matrix3d::Identity(), joint.axis * joint.fixed_value};
    }
    return {rotation_about(joint.axis, joint.fixed_value), Vec3::Zero()};
  }

  void add_shapes(int link_index) {
    const Link& link = robot_.links()[static_cast<std::size_t>(link_index)];
    const Placement& placement = placements_[static_cast<std::size_t>(link_index)];
    LinkRow row;
    row.link = link_index;
    row.frame = placement.frame;
    row.sphere_begin = static_cast<int>(tables_.spheres.size());
    row.capsule_begin = static_cast<int>(tables_.capsules.size());
    for (const Sphere& sphere : link.spheres) {
      SphereRow out{};
      store(placement.X_frame_link * sphere.center, out.center);
      out.radius = static_cast<float>(sphere.radius);
      tables_.spheres.push_back(out);
    }
    for (const Capsule& capsule : link.capsules) {
      CapsuleRow out{};
      store(placement.X_frame_link * capsule.a, out.a);
      store(placement.X_frame_link * capsule.b, out.b);
      out.radius = static_cast<float>(capsule.radius);
      tables_.capsules.push_back(out);
    }
    row.sphere_end = static_cast<int>(tables_.spheres.size());
    row.capsule_end = static_cast<int>(tables_.capsules.size());
    bound(link, placement, row);
    (placement.frame < 0 ? tables_.fixed_links : tables_.links).push_back(row);
  }

  /// A sphere about the middle of the shapes' extent; exact for a single shape.
  static void bound(const Link& link, const Placement& placement, LinkRow& row) {
    Vec3 lower = Vec3::Constant(INFINITY), upper = Vec3::Constant(-INFINITY);
    const auto extend = [&](const Vec3& p, double radius) {
      lower = lower.cwiseMin(p - Vec3::Constant(radius));
      upper = upper.cwiseMax(p + Vec3::Constant(radius));
    };
    for (const Sphere& s : link.spheres) extend(s.center, s.radius);
    for (const Capsule& c : link.capsules) {
      extend(c.a, c.radius);
      extend(c.b, c.radius);
    }
    const Vec3 center = (lower + upper) / 2;
    double radius = 0;
    for (const Sphere& s : link.spheres)
      radius = std::max(radius, (s.center - center).norm() + s.radius);
    for (const Capsule& c : link.capsules) {
      radius =
          std::max({radius, (c.a - center).norm() + c.radius, (c.b - center).norm() + c.radius});
    }
    store(placement.X_frame_link * center, row.center);
    // Rounding to float must not shrink the bound.
    row.radius = static_cast<float>(radius * (1 + 1e-6) + 1e-6);
  }

  void add_pair(int a, int b, const std::vector<int>& row_of_link) {
    const bool is_a_fixed = placements_[static_cast<std::size_t>(a)].frame < 0;
    const bool is_b_fixed = placements_[static_cast<std::size_t>(b)].frame < 0;
    const int row_a = row_of_link[static_cast<std::size_t>(a)];
    const int row_b = row_of_link[static_cast<std::size_t>(b)];
    if (is_a_fixed) {
      tables_.fixed_pairs.emplace_back(row_b, row_a);
    } else if (is_b_fixed) {
      tables_.fixed_pairs.emplace_back(row_a, row_b);
    } else {
      tables_.pairs.emplace_back(row_a, row_b);
    }
  }

  const Robot& robot_;
  std::map<int, int> group_index_;
  std::vector<Placement> placements_;
  RobotTables tables_;
};

/// Coordinates up to here keep the kernels' error below a millimetre; see docs/numerics.md.
constexpr double kFarthest = 1e4;

bool is_rotation(const Eigen::Matrix3d& matrix) {
  return (matrix * matrix.transpose()).isIdentity(1e-6) && matrix.determinant() > 0;
}

/// What is wrong with a shape, or nothing. Comparisons are written so that a NaN is wrong.
std::string_view find_flaw(const Shape& shape) {
  const Sphere bound = bounding_sphere(shape);
  if (!(bound.center.norm() + bound.radius <= kFarthest))
    return "is not finite or extends beyond 10 km";
  const auto* sphere = std::get_if<Sphere>(&shape);
  const auto* capsule = std::get_if<Capsule>(&shape);
  const auto* box = std::get_if<Box>(&shape);
  const bool is_sized = (!sphere || sphere->radius > 0) && (!capsule || capsule->radius > 0) &&
                        (!box || (box->half_extents.array() > 0).all());
  if (!is_sized) return "has a size that is not positive";
  if (box && !is_rotation(box->pose.rotation)) return "is posed by a matrix that is no rotation";
  return {};
}

Result<void> add_shape(const Shape& shape, const std::string& obstacle, SceneTables& tables) {
  if (const std::string_view flaw = find_flaw(shape); !flaw.empty()) {
    return fail(ErrorCode::invalid, "obstacle '" + obstacle + "': a " +
                                        std::string(shape_name(shape)) + " " + std::string(flaw));
  }
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    SphereRow row{};
    store(sphere->center, row.center);
    row.radius = static_cast<float>(sphere->radius);
    tables.spheres.push_back(row);
  } else if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    CapsuleRow row{};
    store(capsule->a, row.a);
    store(capsule->b, row.b);
    row.radius = static_cast<float>(capsule->radius);
    tables.capsules.push_back(row);
  } else if (const auto* box = std::get_if<Box>(&shape)) {
    BoxRow row{};
    store(box->pose.translation, row.center);
    store(Eigen::Matrix3d(box->pose.rotation.transpose()), row.rotation);
    store(box->half_extents, row.half_extents);
    row.bounding_radius = static_cast<float>(box->half_extents.norm() * (1 + 1e-6));
    tables.boxes.push_back(row);
  } else {
    return fail(ErrorCode::unsupported,
                "obstacle '" + obstacle +
                    "': collision checking of a cylinder is not supported; use a capsule or a box");
  }
  return {};
}

}  // namespace

Result<RobotTables> make_robot_tables(const Robot& robot) {
  RobotTables tables = RobotTablesBuilder(robot).build();
  if (tables.frames.size() > static_cast<std::size_t>(kMaxRows) ||
      tables.links.size() > static_cast<std::size_t>(kMaxRows)) {
    return fail(ErrorCode::unsupported, "robot '" + robot.name() + "' has more than " +
                                            std::to_string(kMaxRows) +
                                            " joints or moving links with collision shapes");
  }
  return tables;
}

Result<SceneTables> make_scene_tables(const Scene& scene) {
  SceneTables tables;
  for (const Obstacle& obstacle : scene.obstacles) {
    if (obstacle.shapes.empty()) {
      return fail(ErrorCode::invalid, "obstacle '" + obstacle.name + "' has no shapes");
    }
    for (const Shape& shape : obstacle.shapes) {
      if (auto added = add_shape(shape, obstacle.name, tables); !added)
        return tl::unexpected(added.error());
    }
  }
  return tables;
}

}  // namespace mneme::internal
