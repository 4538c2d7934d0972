// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "check/solid_pairs.h"

#include "base/as_index.h"
#include "robot/kinematics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mneme::internal {
namespace {

/// Metres: where there is less room, a motion is taken to touch.
constexpr double kLeastRoom = 1e-4;
/// Metres: whether there is more room is not looked at, because covers alone tell so much.
constexpr double kMostRoom = 0.01;

}  // namespace

SolidPairs::SolidPairs(const Robot& robot, const LinkDistances& links, const Scene& scene)
    : robot_(robot), links_(links) {
  for (const ObstacleShape& obstacle : obstacle_shapes(robot, scene)) {
    for (const int link : obstacle.by_solid) {
      if (!links.is_moving(link)) continue;
      auto shape = std::make_shared<const Shape>(*obstacle.shape);
      ObstacleShape own = obstacle;
      own.shape = shape.get();
      pairs_.push_back({link, std::move(shape), std::move(own)});
    }
  }
}

PosedLinks SolidPairs::pose(const Configuration& q) const {
  return links_.posed(robot_.link_poses(q));
}

bool SolidPairs::are_all_apart(std::span<const float> q, double margin) const {
  const PosedLinks posed = pose({q.begin(), q.end()});
  return std::ranges::none_of(pairs_, [&](const Pair& pair) {
    return links_.between(posed, pair.link, pair.obstacle, margin) < margin;
  });
}

bool SolidPairs::stay_all_apart(std::span<const float> from, std::span<const float> delta,
                                double margin) const {
  const Configuration begin(from.begin(), from.end());
  const auto at = [&](double share) {
    Configuration q = begin;
    for (std::size_t j = 0; j < q.size(); ++j) q[j] += share * delta[j];
    return q;
  };
  std::vector<double> ways;
  for (const Pair& pair : pairs_) ways.push_back(longest_way(pair.link, begin, at(1)));
  for (double share = 0; share < 1;) {
    const PosedLinks posed = pose(at(share));
    double step = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const double enough = margin + std::min(kLeastRoom + ways[i], kMostRoom);
      const double gap = links_.between(posed, pairs_[i].link, pairs_[i].obstacle, enough);
      const double room = std::min(gap, enough) - margin;
      if (!(room >= kLeastRoom)) return false;
      step = std::min(step, room / ways[i]);
    }
    share += step;
  }
  return true;
}

/// Metres that a point of the link moves at most on the straight motion. A joint that turns moves
/// it along an arc about its axis, which is no farther away than what is between is long.
double SolidPairs::longest_way(int link, const Configuration& from, const Configuration& to) const {
  const std::vector<double> first = joint_values(robot_.joints(), robot_.group(), from);
  const std::vector<double> last = joint_values(robot_.joints(), robot_.group(), to);
  double way = 0, reach = links_.reach(link);
  for (int i = robot_.links()[as_index(link)].parent_joint; i >= 0;) {
    const Joint& joint = robot_.joints()[as_index(i)];
    const double a = first[as_index(i)], b = last[as_index(i)];
    const bool slides = joint.type == JointType::prismatic;
    way += std::abs(b - a) * (slides ? 1 : reach);
    if (slides) reach += std::max(std::abs(a), std::abs(b));
    reach += joint.origin.translation.norm();
    i = robot_.links()[as_index(joint.parent_link)].parent_joint;
  }
  return way;
}

}  // namespace mneme::internal
