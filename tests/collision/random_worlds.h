// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Random robots, scenes and states, and what checkers say of them.
#pragma once

#include "mneme/collision.h"

#include "collision/clearance.h"
#include "tables/make_tables.h"
#include "geometry/random_shapes.h"
#include "support/support.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace mneme::test {

inline CollisionChecker require_checker(const Robot& robot, const Scene& scene,
                                        const CheckerSettings& settings = {}) {
  return require(CollisionChecker::make(robot, scene, settings));
}

inline Robot require_parsed(const std::string& urdf, const RobotOptions& options = {}) {
  return require(parse_robot(urdf, "test.urdf", options));
}

/// Rows of `count` uniform configurations; joints after the first are scaled by `spread`.
inline std::vector<float> random_states(const Robot& robot, int count, Rng& rng,
                                        double spread = 1) {
  std::vector<float> rows;
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < robot.joint_count(); ++j) {
      const double value = rng.uniform(robot.group_joint(j).lower, robot.group_joint(j).upper);
      rows.push_back(static_cast<float>(j == 0 ? value : spread * value));
    }
  }
  return rows;
}

inline std::span<const float> row(const std::vector<float>& rows, std::size_t index,
                                  const Robot& robot) {
  const auto joints = static_cast<std::size_t>(robot.joint_count());
  return {rows.data() + index * joints, joints};
}

inline std::vector<std::uint8_t> check_all(const CollisionChecker& checker,
                                           const std::vector<float>& rows) {
  std::vector<std::uint8_t> is_valid(rows.size() /
                                     static_cast<std::size_t>(checker.robot().joint_count()));
  checker.check_states(rows, is_valid);
  return is_valid;
}

/// Circles around planar8's base, none of them at it.
inline Scene random_circles(int count, Rng& rng) {
  std::vector<std::array<double, 3>> circles;
  for (int i = 0; i < count; ++i) {
    const double direction = rng.uniform(-kPi, kPi);
    const double distance = rng.uniform(1.5, 9.0);
    circles.push_back(
        {distance * std::cos(direction), distance * std::sin(direction), rng.uniform(0.05, 1.2)});
  }
  return make_circle_scene("circles", circles);
}

inline Vec3 random_axis(Rng& rng) {
  const std::uint32_t kind = rng.index(8);
  if (kind < 3) return Vec3::Unit(kind);
  if (kind < 6) return -Vec3::Unit(kind - 3);
  return random_pose(rng, 1.0).rotation.col(0);
}

/// One or two spheres or capsules of a few decimetres.
inline Link random_link(const std::string& name, Rng& rng) {
  Link link;
  link.name = name;
  const std::uint32_t kind = rng.index(8);
  if (kind == 0) return link;
  if (kind != 1) {
    const Vec3 a = random_vector(rng, 0.1);
    link.capsules.push_back({a, a + random_vector(rng, 0.5), rng.uniform(0.01, 0.1)});
  }
  if (kind <= 3) link.spheres.push_back({random_vector(rng, 0.3), rng.uniform(0.02, 0.12)});
  if (kind == 4) link.capsules.push_back({Vec3::Zero(), random_vector(rng, 0.3), 0.05});
  return link;
}

inline Joint random_joint(int child, Rng& rng) {
  constexpr std::array kTypes = {JointType::fixed,    JointType::prismatic,  JointType::revolute,
                                 JointType::revolute, JointType::continuous, JointType::revolute};
  Joint joint;
  joint.name = "joint" + std::to_string(child);
  joint.type = kTypes.at(rng.index(kTypes.size()));
  joint.child_link = child;
  const bool is_branch = rng.index(4) == 0;
  joint.parent_link =
      is_branch ? static_cast<int>(rng.index(static_cast<std::uint32_t>(child))) : child - 1;
  joint.origin = random_pose(rng, 0.4);
  joint.axis = random_axis(rng);
  if (rng.index(3) == 0) joint.origin.rotation.setIdentity();
  const bool is_prismatic = joint.type == JointType::prismatic;
  joint.lower = is_prismatic ? -0.3 : joint.type == JointType::continuous ? -kPi : -2.5;
  joint.upper = is_prismatic ? 0.5 : joint.type == JointType::continuous ? kPi : 2.8;
  return joint;
}

/// Now and then makes the last joint follow one that is in the group.
inline bool follows_another(Robot::Parts& parts, const std::vector<std::string>& group, Rng& rng) {
  if (group.empty() || rng.index(6) != 0) return false;
  const std::string& leader = group[rng.index(static_cast<std::uint32_t>(group.size()))];
  const auto found = std::ranges::find(parts.joints, leader, &Joint::name);
  if (found->type == JointType::continuous) return false;
  parts.joints.back().mimic = Mimic{static_cast<int>(found - parts.joints.begin()),
                                    rng.uniform(-1.5, 1.5), rng.uniform(-0.5, 0.5)};
  return true;
}

/// A tree of 5 to 10 links about random axes. Some movable joints stand still outside the group,
/// whose order is not that of the tree; some follow others.
inline Robot random_robot(Rng& rng) {
  while (true) {
    Robot::Parts parts;
    parts.name = "tree";
    parts.links.push_back(random_link("link0", rng));
    RobotOptions options;
    const int count = 4 + static_cast<int>(rng.index(6));
    for (int i = 1; i <= count; ++i) {
      parts.links.push_back(random_link("link" + std::to_string(i), rng));
      parts.joints.push_back(random_joint(i, rng));
      const Joint& joint = parts.joints.back();
      if (joint.type == JointType::fixed) continue;
      if (rng.index(6) == 0) {
        options.fixed_values[joint.name] = rng.uniform(joint.lower, joint.upper);
      } else if (!follows_another(parts, options.joints, rng)) {
        options.joints.insert(options.joints.begin() +
                                  rng.index(static_cast<std::uint32_t>(options.joints.size()) + 1),
                              joint.name);
      }
    }
    if (options.joints.size() < 3) continue;
    return require(make_robot(std::move(parts), options));
  }
}

/// Half of the pairs of obstacles and links.
inline void check_obstacles_exactly(Scene& scene, const Robot& robot, Rng& rng) {
  for (Obstacle& obstacle : scene.obstacles) {
    for (const Link& link : robot.links()) {
      if (rng.index(2) == 0) obstacle.exact_links.push_back(link.name);
    }
  }
}

/// Three in four of the pairs of links that the robot checks; names stand in either order.
inline void check_links_exactly(Scene& scene, const Robot& robot, Rng& rng) {
  for (const auto& [a, b] : robot.self_pairs()) {
    const auto name = [&](int link) { return robot.links()[static_cast<std::size_t>(link)].name; };
    if (rng.index(2) == 0) {
      scene.exact_pairs.emplace_back(name(a), name(b));
    } else if (rng.index(2) == 0) {
      scene.exact_pairs.emplace_back(name(b), name(a));
    }
  }
}

/// True if the links that no joint of the group moves touch nothing.
inline bool leaves_fixed_links_alone(const Robot& robot, const Scene& scene) {
  const auto checked = require(internal::share_checked_robot(robot));
  return internal::find_fixed_contacts(robot, checked->links, scene).empty();
}

/// `count` obstacles made by `make_shape(rng)` that leave links without a moving joint alone.
template <class MakeShape>
Scene random_scene(const Robot& robot, int count, Rng& rng, const MakeShape& make_shape) {
  Scene scene;
  scene.name = "random";
  for (int attempt = 0; attempt < 1000 && std::ssize(scene.obstacles) < count; ++attempt) {
    const std::string name = "obstacle" + std::to_string(scene.obstacles.size());
    const Shape shape = make_shape(rng);
    const Obstacle obstacle{name, {transformed(random_pose(rng, 1.5), shape)}};
    if (leaves_fixed_links_alone(robot, Scene{"one", {obstacle}})) {
      scene.obstacles.push_back(obstacle);
    }
  }
  return scene;
}

inline Shape small_sphere(Rng& rng) { return Sphere{Vec3::Zero(), rng.uniform(0.02, 0.4)}; }
inline Shape small_box(Rng& rng) {
  return Box{{}, random_vector(rng, 0.4).cwiseAbs() + Vec3::Constant(0.01)};
}
inline Shape small_capsule(Rng& rng) {
  return Capsule{Vec3::Zero(), random_vector(rng, 0.7), rng.uniform(0.01, 0.2)};
}
inline Shape small_cylinder(Rng& rng) {
  return Cylinder{{}, rng.uniform(0.01, 0.3), rng.uniform(0.02, 0.8)};
}
inline Shape small_shape(Rng& rng) {
  constexpr std::array kMakers = {small_sphere, small_box, small_capsule, small_cylinder};
  return kMakers.at(rng.index(kMakers.size()))(rng);
}

}  // namespace mneme::test
