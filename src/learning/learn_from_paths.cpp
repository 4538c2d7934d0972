// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "learning/body_points.h"
#include "mneme/learning.h"

namespace mneme {
namespace {

/// Distances between the moving shapes of a robot and the obstacles of a scene.
class Nearness {
 public:
  Nearness(const Robot& robot, const Scene& scene, double reach)
      : robot_(robot), scene_(scene), reach_(reach), is_moving_(internal::arm_links(robot)) {}

  /// Poses the robot: near(shape, obstacle) for each of its moving shapes.
  void look_at(const Configuration& q) {
    const std::vector<Transform> poses = robot_.link_poses(q);
    near_.clear();
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (!is_moving_[i]) continue;
      for (const Sphere& sphere : robot_.links()[i].spheres) {
        const Vec3 center = poses[i] * sphere.center;
        add(center, center, sphere.radius);
      }
      for (const Capsule& capsule : robot_.links()[i].capsules) {
        add(poses[i] * capsule.a, poses[i] * capsule.b, capsule.radius);
      }
    }
  }

  /// True if one shape is close to all of `obstacles`.
  [[nodiscard]] bool is_close_to_all(const std::vector<int>& obstacles) const {
    return std::ranges::any_of(near_, [&](const std::vector<bool>& near) {
      return std::ranges::all_of(
          obstacles, [&](int obstacle) { return near[static_cast<std::size_t>(obstacle)]; });
    });
  }

 private:
  void add(const Vec3& a, const Vec3& b, double radius) {
    std::vector<bool> near;
    for (const Obstacle& obstacle : scene_.obstacles) {
      near.push_back(std::ranges::any_of(obstacle.shapes, [&](const Shape& shape) {
        return distance_to_segment(a, b, shape) < radius + reach_;
      }));
    }
    near_.push_back(std::move(near));
  }

  const Robot& robot_;
  const Scene& scene_;
  double reach_;
  std::vector<bool> is_moving_;
  std::vector<std::vector<bool>> near_;
};

}  // namespace

Result<std::vector<Experience>> learn_from_paths(const Robot& robot, const Scene& scene,
                                                 std::span<const Path> paths,
                                                 const DecomposeSettings& settings, double reach) {
  if (settings.decomposer == "paths") return learn_whole_paths(robot, paths);
  const auto primitives = decompose(robot, scene, settings);
  if (!primitives) return tl::unexpected(primitives.error());
  const std::string kind =
      decomposer_version(settings.decomposer.empty() ? default_decomposer(robot)
                                                     : settings.decomposer)
          .value();
  const SymmetricJoints joints = find_symmetric_joints(robot);
  Nearness nearness(robot, scene, reach);
  std::vector<Experience> rows(primitives->size());
  for (const Path& path : paths) {
    for (const Configuration& q : path) {
      nearness.look_at(q);
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const LocalPrimitive& primitive = (*primitives)[i];
        if (!nearness.is_close_to_all(primitive.obstacles)) continue;
        const Configuration mean = moved_configuration(joints, inverse(primitive.to_scene), q);
        LocalSampler& sampler = rows[i].sampler;
        sampler.joint_count = robot.joint_count();
        sampler.means.insert(sampler.means.end(), mean.begin(), mean.end());
        rows[i].kind = kind;
        rows[i].key = primitive.key;
      }
    }
  }
  std::erase_if(rows, [](const Experience& row) { return row.key.empty(); });
  return rows;
}

}  // namespace mneme
