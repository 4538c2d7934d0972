// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Contacts of a robot with itself by FCL on its exact geometry, over all pairs of links that may
/// not touch: not only those that mneme checks.
#pragma once

#include "mneme/spheres.h"

#include "geometry/fcl_shapes.h"

#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace mneme::test {

using LinkPair = std::pair<int, int>;
using NamedPairs = std::vector<std::pair<std::string, std::string>>;

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

  [[nodiscard]] bool has_shapes(int link) const {
    return !links_[static_cast<std::size_t>(link)].empty();
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

  /// As touch(), but faces that coincide touch, too, although rounding may part them.
  [[nodiscard]] bool meet(const LinkPair& pair) const {
    constexpr double kTouching = 1e-6;  // metres
    if (touch(pair)) return true;
    for (const Part& a : links_[static_cast<std::size_t>(pair.first)]) {
      for (const Part& b : links_[static_cast<std::size_t>(pair.second)]) {
        fcl::DistanceResultd result;
        const double distance =
            fcl::distance(a.object.get(), b.object.get(), fcl::DistanceRequestd{}, result);
        if (distance <= kTouching) return true;
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

/// True if a joint joins two links, directly or through links without shapes.
inline bool are_joined(const Robot& robot, const FclRobot& oracle, const LinkPair& pair) {
  const auto above = [&](int link) {
    for (const Joint& joint : robot.joints()) {
      if (joint.child_link == link) return joint.parent_link;
    }
    return -1;
  };
  const auto carries = [&](int carrier, int link) {
    do link = above(link);
    while (link >= 0 && link != carrier && !oracle.has_shapes(link));
    return link == carrier;
  };
  return carries(pair.first, pair.second) || carries(pair.second, pair.first);
}

/// Removes the pairs that touch in all of 1000 random configurations: nothing seems to part them.
inline void remove_inseparable(const Robot& robot, FclRobot& oracle, std::vector<LinkPair>& pairs) {
  constexpr int kSamples = 1000;
  Rng rng(3);
  std::vector<LinkPair> open = pairs;
  for (int i = 0; i < kSamples && !open.empty(); ++i) {
    oracle.move_to(sampled_configuration(robot, rng));
    std::erase_if(open, [&](const LinkPair& pair) { return !oracle.meet(pair); });
  }
  std::erase_if(pairs,
                [&](const LinkPair& pair) { return std::ranges::find(open, pair) != open.end(); });
}

/// All pairs that move against each other, except those that an SRDF allows or, without one, that
/// a joint joins, and those that nothing parts. Derived from the tree of links and by FCL alone.
inline Result<std::vector<LinkPair>> pairs_to_check(const std::string& path, const Robot& robot,
                                                    FclRobot& oracle,
                                                    const RobotOptions& options = {}) {
  const Robot::Parts parts = MNEME_TRY(read_robot(path, options));
  std::set<LinkPair> allowed;
  for (const auto& [first, second] : parts.allowed_pairs.value_or(NamedPairs())) {
    const auto a = robot.find_link(first), b = robot.find_link(second);
    if (a && b) allowed.insert(std::minmax(*a, *b));
  }
  Rng rng(3);
  const Configuration q = sampled_configuration(robot, rng),
                      other = sampled_configuration(robot, rng);
  std::vector<LinkPair> pairs;
  for (int a = 0; a < static_cast<int>(robot.links().size()); ++a) {
    for (int b = a + 1; b < static_cast<int>(robot.links().size()); ++b) {
      if (!oracle.has_shapes(a) || !oracle.has_shapes(b)) continue;
      const bool is_allowed =
          parts.allowed_pairs ? allowed.contains({a, b}) : are_joined(robot, oracle, {a, b});
      if (!is_allowed && !have_same_pose(robot, {a, b}, q, other)) pairs.emplace_back(a, b);
    }
  }
  remove_inseparable(robot, oracle, pairs);
  return pairs;
}

}  // namespace mneme::test
