// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Panda on a motion among boxes, which can be turned about its axis.
#pragma once

#include "support/planar_memory.h"

#include <Eigen/Geometry>

#include <cmath>
#include <string>

namespace mneme::test {

inline Robot panda() {
  auto robot =
      find_robot("panda").and_then([](const std::string& path) { return load_robot(path); });
  REQUIRE(robot.has_value());
  return *std::move(robot);
}

inline Path bent_motion(double lift = 0) {
  return {{0.1, -0.4 + lift, 0.2, -2.0, 0.1, 1.7, 0.5},
          {0.5, 0.1 + lift, -0.1, -1.6, 0.6, 1.9, 0.9},
          {0.9, 0.3 + lift, 0.3, -2.1, 0.9, 2.4, 0.2}};
}

/// Boxes around the forearm and hand, 3 mm from the motion.
inline Scene enclose(const Robot& robot, const Path& motion, std::uint64_t seed) {
  Rng rng(seed);
  Scene scene;
  for (int i = 0; i < 4000 && scene.obstacles.size() < 1500; ++i) {
    const auto poses =
        robot.link_poses(motion[rng.index(static_cast<std::uint32_t>(motion.size()))]);
    const std::size_t half = poses.size() / 2;
    Vec3 center = poses[half + rng.index(static_cast<std::uint32_t>(half))].translation, size;
    for (const int axis : {0, 1, 2}) center[axis] += rng.uniform(-0.25, 0.25);
    for (const int axis : {0, 1, 2}) size[axis] = rng.uniform(0.015, 0.06);
    const Box box{{Eigen::Matrix3d::Identity(), center}, size};
    const auto checker = make_checker(robot, {"", {{"", {box}}}}, 0.003);
    CheckCounters counters;
    if (!checker.fixed_contacts().empty()) continue;
    if (!checker.is_valid(std::span<const double>(motion.front()))) continue;
    if (find_invalid_motion(checker, motion, counters) >= 0) continue;
    scene.obstacles.push_back({"box_" + std::to_string(i), {box}});
  }
  REQUIRE(scene.obstacles.size() > 50);
  return scene;
}

inline Scene turned(Scene scene, double angle) {
  const Transform turn{rotation_about(Vec3::UnitZ(), angle), Vec3::Zero()};
  for (Obstacle& obstacle : scene.obstacles) {
    Box& box = std::get<Box>(obstacle.shapes.front());
    box.pose = turn * box.pose;
  }
  return scene;
}

inline Path turned(const Path& path, double angle) {
  Path result = path;
  for (Configuration& q : result) q.front() += angle;
  return result;
}

}  // namespace mneme::test
