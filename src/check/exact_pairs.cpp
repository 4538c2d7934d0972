// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "check/link_distances.h"
#include "base/as_index.h"
#include "robot/kinematics.h"

#include <algorithm>
#include <cmath>

namespace mneme::internal {
namespace {

/// A motion with less room, in metres, counts as in contact.
constexpr double kLeastRoom = 1e-4;
/// Exact geometry is not checked where spheres have this much room, in metres.
constexpr double kSphereRoom = 0.003;

/// A stretch of a motion, between two fractions of it, on which a pair is not yet proven apart.
struct Stretch {
  std::size_t pair = 0;
  double first = 0, last = 1;
};

}  // namespace

ExactPairs::ExactPairs(const Robot& robot, const LinkDistances& links, const Scene& scene,
                       double margin)
    : robot_(robot), links_(links) {
  for (const ObstacleShape& obstacle : obstacle_shapes(robot, scene)) {
    for (const int link : obstacle.exact_links) {
      if (!links.is_moving(link)) continue;
      auto shape = std::make_shared<const Shape>(*obstacle.shape);
      ObstacleShape own = obstacle;
      own.shape = shape.get();
      pairs_.push_back({link, margin, std::move(shape), std::move(own)});
    }
  }
  for (const LinkPair& pair : link_pairs(robot, scene)) {
    if (pair.is_exact) pairs_.push_back({.link = pair.first, .links = pair});
  }
}

PosedLinks ExactPairs::pose(const Configuration& q) const {
  return links_.posed(robot_.link_poses(q));
}

double ExactPairs::between(const PosedLinks& posed, const Pair& pair, double enough) const {
  return pair.shape ? links_.between(posed, pair.link, pair.obstacle, enough)
                    : links_.between(posed, pair.links, enough);
}

/// Metres that a pair may approach before it touches. Exact up to `most`, otherwise any larger
/// value.
double ExactPairs::room(const PosedLinks& posed, const Pair& pair, double margin,
                        double most) const {
  const double enough = margin + most;
  const auto [first, second, is_exact] = pair.links;
  const double spheres = pair.shape
                             ? links_.between_spheres(posed, pair.link, pair.obstacle, enough)
                             : links_.between_spheres(posed, first, second, enough);
  if (spheres > margin + std::min(most, kSphereRoom)) return spheres - margin;
  return between(posed, pair, enough) - margin;
}

bool ExactPairs::are_apart(std::span<const float> q) const {
  const PosedLinks posed = pose({q.begin(), q.end()});
  return std::ranges::none_of(
      pairs_, [&](const Pair& pair) { return between(posed, pair, pair.margin) < pair.margin; });
}

bool ExactPairs::stay_apart(std::span<const float> from, std::span<const float> delta,
                            double extra) const {
  const Configuration begin(from.begin(), from.end());
  const auto at = [&](double share) {
    Configuration q = begin;
    for (std::size_t j = 0; j < q.size(); ++j) q[j] += share * delta[j];
    return q;
  };
  std::vector<double> bounds;
  std::vector<Stretch> open;
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    bounds.push_back(displacement_bound(pairs_[i], begin, at(1)));
    open.push_back({i});
  }
  // Breadth first: long stretches of all pairs find a contact early.
  for (std::size_t next = 0; next < open.size(); ++next) {
    const auto [i, first, last] = open[next];
    const double middle = 0.5 * (first + last), half = 0.5 * (last - first) * bounds[i];
    const double margin = pairs_[i].margin + extra;
    const double room = this->room(pose(at(middle)), pairs_[i], margin, half + kLeastRoom);
    if (!(room >= kLeastRoom)) return false;
    if (room >= half) continue;
    const double known = room / bounds[i];
    open.push_back({i, middle + known, last});
    open.push_back({i, first, middle - known});
  }
  return true;
}

/// Bound on the approach of a pair on the straight motion, metres.
double ExactPairs::displacement_bound(const Pair& pair, const Configuration& from,
                                      const Configuration& to) const {
  const std::vector<double> first = joint_values(robot_.joints(), robot_.group(), from);
  const std::vector<double> last = joint_values(robot_.joints(), robot_.group(), to);
  std::vector<int> own = joints_to(robot_, pair.link);
  if (pair.shape) return displacement_bound(pair.link, own, first, last);
  // Joints that carry both links do not change their distance.
  std::vector<int> others = joints_to(robot_, pair.links.second);
  while (!own.empty() && !others.empty() && own.back() == others.back()) {
    own.pop_back();
    others.pop_back();
  }
  return displacement_bound(pair.link, own, first, last) +
         displacement_bound(pair.links.second, others, first, last);
}

/// Displacement bound of the link's points, metres, by the joints that carry it, from the link to
/// the root. The radius of a turn is at most the length of the chain between joint and point.
double ExactPairs::displacement_bound(int link, std::span<const int> joints,
                                      const std::vector<double>& from,
                                      const std::vector<double>& to) const {
  double bound = 0, reach = links_.reach(link);
  for (const int i : joints) {
    const Joint& joint = robot_.joints()[as_index(i)];
    const double a = from[as_index(i)], b = to[as_index(i)];
    const bool slides = joint.type == JointType::prismatic;
    bound += std::abs(b - a) * (slides ? 1 : reach);
    if (slides) reach += std::max(std::abs(a), std::abs(b));
    reach += joint.origin.translation.norm();
  }
  return bound;
}

}  // namespace mneme::internal
