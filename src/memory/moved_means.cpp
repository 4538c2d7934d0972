// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/moved_means.h"

#include "robot/joint_space.h"

#include <algorithm>
#include <cmath>

namespace mneme::internal {
namespace {

class Synthesizer {
 public:
  Synthesizer(const Robot& robot, std::size_t component_count)
      : space_(robot), symmetric_(find_symmetric_joints(robot)) {
    pooled_.joint_count = robot.joint_count();
    pooled_.means.reserve(component_count * static_cast<std::size_t>(robot.joint_count()));
    pooled_.sources.reserve(component_count);
    pooled_.factor_rows.reserve(component_count);
  }

  void add(const Match& match, SampleSource source) {
    const GaussianMixture& local = match.experience->sampler();
    const auto joints = static_cast<std::size_t>(local.joint_count);
    for (int i = 0; i < local.component_count(); ++i) {
      const float* mean = local.means.data() + static_cast<std::size_t>(i) * joints;
      if (!add_moved_mean(match.to_scene, {mean, joints})) continue;
      pooled_.sources.push_back(source);
      // Symmetries do not change a covariance: a rotation or lift adds to the mean, a mirror image
      // negates all joints.
      pooled_.add_factor(local.factor(i));
    }
  }

  GaussianMixture take() { return std::move(pooled_); }

 private:
  bool add_moved_mean(const Symmetry& motion, std::span<const float> mean) {
    const std::size_t begin = pooled_.means.size();
    pooled_.means.resize(begin + mean.size());
    float* moved = pooled_.means.data() + begin;
    const float sign = motion.is_mirrored ? -1.0f : 1.0f;
    for (std::size_t j = 0; j < mean.size(); ++j) moved[j] = sign * mean[j];
    if (symmetric_.turn >= 0) turn(moved[symmetric_.turn], motion.rotation);
    if (symmetric_.lift >= 0) moved[symmetric_.lift] += static_cast<float>(motion.lift);
    bool is_inside = true;
    for (std::size_t j = 0; j < mean.size(); ++j) {
      const float inside = space_.into_limits(static_cast<int>(j), moved[j]);
      is_inside &= space_.periods()[j] > 0 || std::abs(inside - moved[j]) <= kLimitTolerance;
      moved[j] = inside;
    }
    if (!is_inside) pooled_.means.resize(begin);
    return is_inside;
  }

  /// Wraps the value into the turn around the middle of the limits.
  void turn(float& value, double rotation) const {
    const float middle = 0.5f * (space_.lower(symmetric_.turn) + space_.upper(symmetric_.turn));
    value += static_cast<float>(rotation);
    value -= kTurn * std::nearbyint((value - middle) / kTurn);
  }

  static constexpr float kTurn = 6.28318530718f;
  static constexpr float kLimitTolerance = 1e-5f;
  JointSpace space_;
  SymmetricJoints symmetric_;
  GaussianMixture pooled_;
};

/// Flags per link: true if a joint of the group moves it. A lift of a robot with a turning joint is
/// not counted, because no symmetry turns the links that only the lift carries, such as a torso or
/// a head.
std::vector<bool> arm_links(const Robot& robot) {
  const SymmetricJoints symmetric = find_symmetric_joints(robot);
  const int ignored = symmetric.turn >= 0 ? symmetric.lift : -1;
  std::vector<bool> is_moving(robot.links().size(), false);
  for (std::size_t i = 0; i < is_moving.size(); ++i) {
    const int joint = robot.links()[i].parent_joint;
    if (joint < 0) continue;
    const auto parent = robot.joints()[static_cast<std::size_t>(joint)].parent_link;
    const auto found = std::ranges::find(robot.group(), joint);
    const bool is_moved_here =
        found != robot.group().end() && found - robot.group().begin() != ignored;
    is_moving[i] = is_moved_here || is_moving[static_cast<std::size_t>(parent)];
  }
  return is_moving;
}

/// Distances between the moving shapes of a robot and the obstacles of a scene.
class Nearness {
 public:
  Nearness(const Robot& robot, const Scene& scene, double reach)
      : robot_(robot), scene_(scene), reach_(reach), is_moving_(arm_links(robot)) {}

  /// Poses the robot: near(shape, obstacle) for each of its moving shapes.
  void pose(const Configuration& q) {
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

GaussianMixture pool_moved_means(const MemoryQuery& query,
                                 std::span<const PrimitiveRetrieval> primitives) {
  std::size_t component_count = 0;
  std::vector<std::pair<const Match*, SampleSource>> matches;
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    for (const Match& match : primitives[i].matches) {
      component_count += static_cast<std::size_t>(match.experience->sampler().component_count());
      matches.emplace_back(&match, static_cast<SampleSource>(i));
    }
  }
  std::ranges::stable_sort(matches, {},
                           [](const auto& entry) { return entry.first->similarity_error; });
  Synthesizer synthesizer(query.robot, component_count);
  for (const auto& [match, source] : matches) synthesizer.add(*match, source);
  return synthesizer.take();
}

std::vector<Experience> gather_waypoints(const MemoryQuery& query,
                                         const std::vector<LocalPrimitive>& primitives,
                                         std::span<const Path> paths, double reach) {
  const SymmetricJoints joints = find_symmetric_joints(query.robot);
  Nearness nearness(query.robot, query.scene, reach);
  std::vector<Experience> rows(primitives.size());
  for (const Path& path : paths) {
    for (const Configuration& q : path) {
      nearness.pose(q);
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const LocalPrimitive& primitive = primitives[i];
        if (!nearness.is_close_to_all(primitive.obstacles)) continue;
        const Configuration mean = moved_configuration(joints, inverse(primitive.to_scene), q);
        LocalSampler& sampler = rows[i].sampler();
        sampler.joint_count = query.robot.joint_count();
        sampler.means.insert(sampler.means.end(), mean.begin(), mean.end());
        rows[i].kind = primitive.kind;
        rows[i].key = primitive.key;
      }
    }
  }
  std::erase_if(rows, [](const Experience& row) { return row.key.empty(); });
  return rows;
}

}  // namespace mneme::internal
