// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "soak/random_problem.h"

#include "soak/fcl_oracle.h"
#include "geometry/random_shapes.h"

#include <cmath>
#include <numbers>

namespace mneme::soak {
namespace {

using test::random_pose;
using test::random_vector;

Configuration random_configuration(const Robot& robot, Rng& rng) {
  Configuration q;
  for (int i = 0; i < robot.joint_count(); ++i) {
    q.push_back(rng.uniform(robot.group_joint(i).lower, robot.group_joint(i).upper));
  }
  return q;
}

Configuration free_of_itself(const Robot& robot, Rng& rng) {
  const Scene empty;
  FclOracle oracle(robot, empty);
  while (true) {
    Configuration q = random_configuration(robot, rng);
    if (!oracle.overlap(q)) return q;
  }
}

/// Where a random point of the moving links is at a random configuration.
Vec3 random_reached_point(const Robot& robot, Rng& rng) {
  const auto poses = robot.link_poses(random_configuration(robot, rng));
  const int first = robot.group_joint(0).child_link;
  const auto count = static_cast<std::uint32_t>(std::ssize(poses) - first);
  return poses[static_cast<std::size_t>(first) + rng.index(count)].translation;
}

Shape shape_in_space(const Vec3& center, Rng& rng) {
  Transform pose = random_pose(rng, 1);
  pose.translation = center;
  switch (rng.index(test::kShapeKinds)) {
    case 0:
      return Sphere{center, rng.uniform(0.02, 0.25)};
    case 1:
      return Box{pose, random_vector(rng, 0.3).cwiseAbs() + Vec3::Constant(0.005)};
    case 2:
      return Cylinder{pose, rng.uniform(0.01, 0.2), rng.uniform(0.02, 0.8)};
    default:
      return Capsule{center, center + random_vector(rng, 0.5), rng.uniform(0.01, 0.15)};
  }
}

Sphere circle(Rng& rng) {
  const double direction = rng.uniform(-std::numbers::pi, std::numbers::pi);
  const double distance = rng.uniform(1.5, 9.0);
  return {{distance * std::cos(direction), distance * std::sin(direction), 0},
          rng.uniform(0.05, 1.4)};
}

/// A circle beside `other`, 0.1 to 0.4 m away from it.
Sphere beside(const Sphere& other, Rng& rng) {
  const double direction = rng.uniform(-std::numbers::pi, std::numbers::pi);
  const double radius = rng.uniform(0.3, 1.4);
  const double distance = other.radius + radius + rng.uniform(0.1, 0.4);
  return {other.center + distance * Vec3(std::cos(direction), std::sin(direction), 0), radius};
}

std::vector<Shape> propose(const Robot& robot, Rng& rng) {
  if (!robot.is_planar()) return {shape_in_space(random_reached_point(robot, rng), rng)};
  const Sphere first = circle(rng);
  if (rng.index(2) == 0) return {first};
  return {first, beside(first, rng)};
}

/// From `q` straight to `other`, up to what it meets there.
Configuration bring_close(FclOracle& oracle, Configuration q, Configuration other, double most) {
  constexpr int kSteps = 40, kHalvings = 60;
  const Configuration begin = q, end = other;
  bool has_met = false;
  for (int step = 1; step <= kSteps && !has_met; ++step) {
    for (std::size_t j = 0; j < q.size(); ++j) {
      other[j] = begin[j] + (end[j] - begin[j]) * step / kSteps;
    }
    has_met = oracle.overlap(other).has_value();
    if (!has_met) q = other;
  }
  for (int i = 0; has_met && i < kHalvings && oracle.clearance(q) > most; ++i) {
    Configuration middle = q;
    for (std::size_t j = 0; j < q.size(); ++j) middle[j] = 0.5 * (q[j] + other[j]);
    (oracle.overlap(middle) ? other : q) = middle;
  }
  return q;
}

}  // namespace

void bring_ends_close(Problem& problem, double most, Rng& rng) {
  FclOracle oracle(problem.robot, problem.scene);
  for (Configuration* end : {&problem.start, &problem.goals[0]}) {
    const double distance = rng.uniform(0, most);
    *end = bring_close(oracle, *end, random_configuration(problem.robot, rng), distance);
  }
}

Problem random_problem(const Robot& robot, double margin, Rng& rng) {
  Problem problem{.name = "random",
                  .robot = robot,
                  .scene = {"random", {}},
                  .start = free_of_itself(robot, rng)};
  problem.goals = {free_of_itself(robot, rng)};
  const auto wanted = 2 + static_cast<std::ptrdiff_t>(rng.index(robot.is_planar() ? 6 : 14));
  for (int tries = 0; tries < 200 && std::ssize(problem.scene.obstacles) < wanted; ++tries) {
    for (const Shape& shape : propose(robot, rng)) {
      const Obstacle obstacle{"obstacle" + std::to_string(problem.scene.obstacles.size()), {shape}};
      const Scene alone{"alone", {obstacle}};
      FclOracle oracle(robot, alone, margin);
      if (oracle.overlap(problem.start) || oracle.overlap(problem.goals[0])) continue;
      problem.scene.obstacles.push_back(obstacle);
    }
  }
  return problem;
}

}  // namespace mneme::soak
