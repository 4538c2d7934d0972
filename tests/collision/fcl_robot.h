// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Contacts of a robot with itself by FCL on its exact geometry, over all pairs of links that its
/// SRDF does not disable: not only those that mneme checks.
#pragma once

#include "mneme/spheres.h"

#include "geometry/fcl_shapes.h"

#include <fcl/narrowphase/collision.h>

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace mneme::test {

using LinkPair = std::pair<int, int>;

/// Exact geometry of a robot's links in FCL.
class FclRobot {
 public:
  explicit FclRobot(const Robot& robot) : robot_(robot) {
    for (const Link& link : robot.links()) {
      std::vector<Part>& parts = links_.emplace_back();
      const auto add = [&](const Shape& shape) {
        const fcl::CollisionObjectd object = std::visit(ToFcl{}, shape);
        parts.push_back({std::make_unique<fcl::CollisionObjectd>(object), object.getTransform()});
      };
      const auto approximated =
          static_cast<std::size_t>(link.approximation ? link.approximation->sphere_count : 0);
      for (std::size_t i = 0; i + approximated < link.spheres.size(); ++i) add(link.spheres[i]);
      const auto replaced =
          static_cast<std::size_t>(link.approximation ? link.approximation->capsule_count : 0);
      for (std::size_t i = 0; i + replaced < link.capsules.size(); ++i) add(link.capsules[i]);
      if (link.approximation) add(link.approximation->surface);
    }
  }

  void move_to(const Configuration& q) {
    const std::vector<Transform> poses = robot_.link_poses(q);
    for (std::size_t i = 0; i < links_.size(); ++i) {
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.linear() = poses[i].rotation;
      pose.translation() = poses[i].translation;
      for (const Part& part : links_[i]) {
        part.object->setTransform(pose * part.in_link);
        part.object->computeAABB();
      }
    }
  }

  /// The first of these pairs that overlaps; null if none does.
  [[nodiscard]] const LinkPair* touching(const std::vector<LinkPair>& pairs) const {
    const auto found = std::ranges::find_if(pairs, [&](const auto& pair) { return touch(pair); });
    return found == pairs.end() ? nullptr : &*found;
  }

  [[nodiscard]] bool touch(const LinkPair& pair) const {
    for (const Part& a : links_[static_cast<std::size_t>(pair.first)]) {
      for (const Part& b : links_[static_cast<std::size_t>(pair.second)]) {
        if (!a.object->getAABB().overlap(b.object->getAABB())) continue;
        fcl::CollisionResultd result;
        if (fcl::collide(a.object.get(), b.object.get(), fcl::CollisionRequestd{}, result) > 0) {
          return true;
        }
      }
    }
    return false;
  }

 private:
  struct Part {
    std::unique_ptr<fcl::CollisionObjectd> object;
    Eigen::Isometry3d in_link;
  };
  const Robot& robot_;
  std::vector<std::vector<Part>> links_;
};

inline bool have_same_pose(const Robot& robot, const LinkPair& pair, const Configuration& q,
                           const Configuration& other) {
  const auto relative = [&](const Configuration& at) {
    const std::vector<Transform> poses = robot.link_poses(at);
    return poses[static_cast<std::size_t>(pair.first)].inverse() *
           poses[static_cast<std::size_t>(pair.second)];
  };
  const Transform a = relative(q), b = relative(other);
  return a.rotation.isApprox(b.rotation, 1e-9) && (a.translation - b.translation).norm() < 1e-9;
}

inline Configuration sampled_configuration(const Robot& robot, Rng& rng) {
  Configuration q;
  for (int i = 0; i < robot.joint_count(); ++i) {
    q.push_back(rng.uniform(robot.group_joint(i).lower, robot.group_joint(i).upper));
  }
  return q;
}

/// True if the robot warns that nothing parts two links.
inline bool always_touch(const Robot& robot, int a, int b) {
  const auto quoted = [&](int link) {
    return "'" + robot.links()[static_cast<std::size_t>(link)].name + "'";
  };
  const std::string text = quoted(a) + " and " + quoted(b) + " touch in every configuration";
  const auto warnings = robot.warnings();
  return std::any_of(warnings.begin(), warnings.end(), [&](const std::string& warning) {
    return warning.find(text) != std::string::npos;
  });
}

/// All pairs that move against each other but for those of an SRDF, or, without one, those that are
/// adjacent or always touch by exact geometry.
inline Result<std::vector<LinkPair>> pairs_to_check(const std::string& path, const Robot& robot,
                                                    const RobotOptions& options = {}) {
  const Robot::Parts parts = MNEME_TRY(read_robot(path, options));
  std::set<LinkPair> allowed;
  const auto allow = [&](const std::string& first, const std::string& second) {
    const auto a = robot.find_link(first), b = robot.find_link(second);
    if (a && b) allowed.insert(std::minmax(*a, *b));
  };
  if (parts.allowed_pairs) {
    for (const auto& [first, second] : *parts.allowed_pairs) allow(first, second);
  } else {
    const auto made = MNEME_TRY(approximate_robot(parts));
    constexpr PairSettings kExact{.samples = 1000, .is_exact = true};
    for (const AllowedPair& pair : MNEME_TRY(derive_allowed_pairs(made.parts, kExact))) {
      if (pair.reason != AllowedReason::never) allow(pair.first, pair.second);
    }
  }
  Rng rng(3);
  const Configuration q = sampled_configuration(robot, rng),
                      other = sampled_configuration(robot, rng);
  std::vector<LinkPair> pairs;
  for (int a = 0; a < static_cast<int>(robot.links().size()); ++a) {
    for (int b = a + 1; b < static_cast<int>(robot.links().size()); ++b) {
      const bool is_still = have_same_pose(robot, {a, b}, q, other);
      if (!allowed.contains({a, b}) && !is_still && !always_touch(robot, a, b)) {
        pairs.emplace_back(a, b);
      }
    }
  }
  return pairs;
}

}  // namespace mneme::test
