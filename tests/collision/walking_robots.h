// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Robots that take steps, where the points of their limbs are in double precision, and steps.
#pragma once

#include "mneme/collision.h"

#include "collision/random_worlds.h"
#include "support/lifting_arm.h"
#include "support/planar_memory.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace mneme::test {

/// Hangs a link on the latest one; its joint is limited to +-`limit`.
inline void hang_next(Robot::Parts& parts, JointType type, const Vec3& offset, const Vec3& axis,
                      double limit, const std::vector<Sphere>& spheres,
                      const std::vector<Capsule>& capsules = {}) {
  hang_link(parts, static_cast<int>(parts.links.size()) - 1,
            joint_at(type, offset, axis, -limit, limit), spheres, capsules);
}

inline Robot::Parts parts_named(const std::string& name) {
  Robot::Parts parts;
  parts.name = name;
  parts.links.push_back({.name = "base"});
  return parts;
}

/// A column that turns all the way, a shoulder, an elbow and a wrist, of spheres.
inline Robot ball_arm() {
  Robot::Parts parts = parts_named("ball_arm");
  hang_next(parts, JointType::continuous, Vec3(0, 0, 0.3), Vec3::UnitZ(), kPi,
            {{Vec3::Zero(), 0.1}});
  hang_next(parts, JointType::revolute, Vec3(0, 0, 0.1), Vec3::UnitY(), 2,
            {{Vec3(0.3, 0, 0), 0.05}, {Vec3(0.5, 0, 0), 0.05}});
  hang_next(parts, JointType::revolute, Vec3(0.6, 0, 0), -Vec3::UnitY(), 2.5,
            {{Vec3(0.2, 0, 0), 0.05}, {Vec3(0.4, 0, 0), 0.05}});
  hang_next(parts, JointType::revolute, Vec3(0.5, 0, 0), Vec3(0, 0.6, 0.8), 2,
            {{Vec3(0.1, 0, 0), 0.04}, {Vec3(0.2, 0.05, 0), 0.04}});
  return robot_of(parts);
}

/// Three slides, a wrist that turns about z and a hand that turns about y. Both links are a ball,
/// or a capsule of 0.3 m, along x at their joints' value 0.
inline Robot::Parts sliding_hand_parts(bool is_capsule) {
  Robot::Parts parts = parts_named("sliding_hand");
  for (const int axis : {0, 1, 2}) {
    hang_next(parts, JointType::prismatic, Vec3::Zero(), Vec3::Unit(axis), 2, {});
  }
  for (const Vec3 axis : {Vec3::UnitZ(), Vec3::UnitY()}) {
    const Vec3 offset = axis.z() == 1 ? Vec3::Zero() : Vec3(0.5, 0, 0);
    if (is_capsule) {
      const Capsule capsule{Vec3(0.1, 0, 0), Vec3(0.4, 0, 0), 0.05};
      hang_next(parts, JointType::revolute, offset, axis, 2, {}, {capsule});
    } else {
      hang_next(parts, JointType::revolute, offset, axis, 2, {{Vec3(0.25, 0, 0), 0.05}});
    }
  }
  return parts;
}
inline Robot sliding_hand(bool is_capsule) { return robot_of(sliding_hand_parts(is_capsule)); }

/// The same with another limb far away, the first one: a step that pulls that one leaves the hand
/// free to go wherever it is pushed.
inline Robot hand_and_pointer(bool is_capsule) {
  Robot::Parts parts = sliding_hand_parts(is_capsule);
  hang_link(parts, 0, joint_at(JointType::revolute, Vec3(0, 0, 10), Vec3::UnitZ(), -2, 2),
            {{Vec3(1, 0, 0), 0.05}}, {});
  return robot_of(parts);
}

/// An arm of three joints about y, of which the last one follows the first, on a turning column.
inline Robot following_arm() {
  Robot::Parts parts = parts_named("following_arm");
  const Capsule bone{Vec3(0.05, 0, 0), Vec3(0.45, 0, 0), 0.03};
  hang_next(parts, JointType::revolute, Vec3(0, 0, 0.2), Vec3::UnitZ(), 2, {});
  hang_next(parts, JointType::revolute, Vec3(0.1, 0, 0), Vec3::UnitY(), 2, {}, {bone});
  hang_next(parts, JointType::revolute, Vec3(0.5, 0, 0), Vec3::UnitY(), 2, {}, {bone});
  hang_next(parts, JointType::revolute, Vec3(0.5, 0, 0), Vec3::UnitY(), 3, {}, {bone});
  parts.joints.back().mimic = Mimic{1, -0.7, 0.4};
  return robot_of(parts);
}

/// A torso that turns about z with a left and a right arm of three joints.
inline Robot two_arms() {
  Robot::Parts parts = parts_named("two_arms");
  hang_next(parts, JointType::revolute, Vec3(0, 0, 0.5), Vec3::UnitZ(), 2, {{Vec3::Zero(), 0.1}});
  for (const double side : {0.3, -0.3}) {
    hang_link(parts, 1, joint_at(JointType::revolute, Vec3(0, side, 0.2), Vec3::UnitZ(), -2, 2), {},
              {});
    const Capsule bone{Vec3(0.05, 0, 0), Vec3(0.4, 0, 0), 0.03};
    hang_next(parts, JointType::revolute, Vec3(0.1, 0, 0), Vec3::UnitY(), 2, {}, {bone});
    hang_next(parts, JointType::revolute, Vec3(0.45, 0, 0), Vec3::UnitY(), 2.4, {}, {bone});
  }
  return robot_of(parts);
}

/// Has `count` joints about z, each with a ball.
inline Robot long_chain(int count) {
  Robot::Parts parts = parts_named("chain");
  parts.allowed_pairs.emplace();
  for (int i = 0; i < count; ++i) {
    hang_next(parts, JointType::revolute, Vec3(0.1, 0, 0), Vec3::UnitZ(), 0.2,
              {{Vec3(0.05, 0, 0), 0.02}});
  }
  return robot_of(parts);
}

/// Where things of a robot are, by its own kinematics.
class LimbFinder {
 public:
  explicit LimbFinder(const Robot& robot) : robot_(robot), frame_(robot.links().size(), -1) {
    for (std::size_t i = 0; i < robot.links().size(); ++i) {
      const int joint = robot.links()[i].parent_joint;
      if (joint < 0) continue;
      frame_[i] = moves(joint) ? static_cast<int>(i) : frame_of(parent_of(static_cast<int>(i)));
    }
  }

  /// Per limb, in the order of CollisionChecker::limbs(), its points at `q`: the tip and the
  /// origins of the joints that turn, on the way to the root. A limb has a length.
  [[nodiscard]] std::vector<std::vector<Vec3>> points(std::span<const double> q) const {
    const std::vector<Transform> poses = robot_.link_poses(q);
    std::vector<std::vector<Vec3>> limbs;
    for (int link = static_cast<int>(frame_.size()) - 1; link >= 0; --link) {
      if (frame_of(link) != link || !is_tip(link)) continue;
      std::vector<Vec3> points = {tip_of(link, poses)};
      for (int at = link; at >= 0; at = frame_of(parent_of(at))) {
        const Joint& joint = robot_.joints()[joint_of(at)];
        if (joint.type != JointType::prismatic) {
          points.push_back(poses[static_cast<std::size_t>(at)].translation);
        }
      }
      if (length_of(points) > 1e-9) limbs.push_back(points);
    }
    return limbs;
  }

  static double length_of(const std::vector<Vec3>& points) {
    double length = 0;
    for (std::size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
    return length;
  }

 private:
  [[nodiscard]] bool moves(int joint_index) const {
    const Joint& joint = robot_.joints()[static_cast<std::size_t>(joint_index)];
    const int leader = joint.mimic ? joint.mimic->joint : joint_index;
    return std::ranges::count(robot_.group(), leader) > 0;
  }
  [[nodiscard]] std::size_t joint_of(int link) const {
    return static_cast<std::size_t>(robot_.links()[static_cast<std::size_t>(link)].parent_joint);
  }
  [[nodiscard]] int parent_of(int link) const {
    return robot_.joints()[joint_of(link)].parent_link;
  }
  [[nodiscard]] int frame_of(int link) const {
    return link < 0 ? -1 : frame_[static_cast<std::size_t>(link)];
  }
  [[nodiscard]] bool is_tip(int link) const {
    for (std::size_t i = 0; i < frame_.size(); ++i) {
      const int other = static_cast<int>(i);
      if (frame_[i] == other && frame_of(parent_of(other)) == link) return false;
    }
    return true;
  }
  /// The point farthest from the joint's origin of what moves with it: a centre or an end.
  [[nodiscard]] Vec3 tip_of(int link, const std::vector<Transform>& poses) const {
    const Vec3 origin = poses[static_cast<std::size_t>(link)].translation;
    Vec3 tip = origin;
    for (std::size_t i = 0; i < frame_.size(); ++i) {
      if (frame_[i] != link) continue;
      for (const Capsule& shape : capsules_of(robot_.links()[i], poses[i])) {
        for (const Vec3& point : {shape.a, shape.b}) {
          if ((point - origin).norm() > (tip - origin).norm()) tip = point;
        }
      }
    }
    return tip;
  }

  const Robot& robot_;
  std::vector<int> frame_;  ///< per link the link whose joint moves it, or -1
};

/// A step and what it refers to; nothing is pushed and nothing drifts unless a test says so.
struct OwnedStep {
  OwnedStep(const Robot& robot, int candidates)
      : drift(static_cast<std::size_t>(robot.joint_count()), 0.0f),
        jitter(static_cast<std::size_t>(3 * candidates), 0.0f) {}

  void randomise_jitter(Rng& rng, double size) {
    for (float& value : jitter) value = static_cast<float>(rng.uniform(-size, size));
  }

  /// Rows of the candidates.
  [[nodiscard]] std::vector<float> take(const CollisionChecker& checker,
                                        std::span<const float> from) const {
    WalkStep step;
    step.limb = limb;
    step.pulled_points = pulled_points;
    step.length = length;
    step.clearance = clearance;
    step.drift = drift;
    step.jitter = jitter;
    std::vector<float> candidates(jitter.size() / 3 * from.size());
    CheckCounters counters;
    checker.walk(from, step, candidates, counters);
    return candidates;
  }

  int limb = 0, pulled_points = 1;
  float length = 0, clearance = 0;
  std::vector<float> drift, jitter;
};

inline std::vector<float> to_row(std::span<const double> q) { return {q.begin(), q.end()}; }
inline Configuration to_configuration(std::span<const float> q) { return {q.begin(), q.end()}; }

/// All but the last one have a single limb.
struct NamedRobot {
  std::string name;
  Robot robot;
  Configuration bent;  ///< far from singular and from limits
};
inline std::vector<NamedRobot> walking_robots() {
  return {{"planar", planar_arm({1, 0.8, 0.6}, 0.02), {0.4, 0.9, -1.1}},
          {"planar8", planar8(), {0.4, 0.9, -1.1, 0.5, 0.7, -0.6, 1, -0.8}},
          {"ball arm", ball_arm(), {1, -0.8, -1.2, 0.9}},
          {"sliding hand", sliding_hand(true), {0.2, -0.3, 0.5, 0.7, -0.9}},
          {"lifting arm", lifting_arm(), {0.25, 0.6, -0.5, 1.3}},
          {"following arm", following_arm(), {0.3, -0.4, 1.1}},
          {"two arms", two_arms(), {0.3, 0.2, -0.5, 1.2, -0.3, -0.4, 1.1}}};
}

}  // namespace mneme::test
