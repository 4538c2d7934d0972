// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/check.h"

#include "base/as_index.h"
#include "base/threads.h"
#include "check/link_distances.h"
#include "check/solid_pair.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace mneme {
namespace {

using internal::as_index, internal::LinkDistances, internal::LinkPair, internal::ObstacleShape,
    internal::PosedLinks;

/// Number of equal steps, at most `resolution` > 0 long, of a motion of this length: 1 to 1e9,
/// where states hardly differ in single precision.
std::int64_t step_count(double length, double resolution) {
  constexpr double kMostSteps = 1e9;
  // In this order of arguments NaN becomes 1.
  return static_cast<std::int64_t>(
      std::max(1.0, std::min(std::ceil(length / resolution), kMostSteps)));
}

/// Calls `visit` for states of the path, at most `resolution` apart, until it returns false.
/// Returns true if it never did.
template <class Visit>
bool visit_states(const Robot& robot, const std::vector<Configuration>& path, double resolution,
                  const Visit& visit) {
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i > 0) {
      const Configuration& from = path[i - 1];
      const Configuration delta = robot.difference(from, path[i]);
      const std::int64_t steps = step_count(robot.distance(from, path[i]), resolution);
      Configuration q = from;
      for (std::int64_t step = 1; step < steps; ++step) {
        const double share = static_cast<double>(step) / static_cast<double>(steps);
        for (std::size_t j = 0; j < q.size(); ++j) q[j] = from[j] + share * delta[j];
        if (!visit(q)) return false;
      }
    }
    if (!visit(path[i])) return false;
  }
  return true;
}

/// Checks the states of motions. A pair that is farther apart at one state than it can approach
/// until another one is not measured there.
class StateCheck {
 public:
  StateCheck(const Robot& robot, const Scene& scene);

  /// True if the states at the shares k / steps of the motion, k = 1 .. steps, are free.
  [[nodiscard]] bool is_free(const Configuration& from, const Configuration& delta,
                             std::int64_t steps) const;

 private:
  /// A link, seen from the root or from another link.
  struct Mover {
    internal::JointChain chain;  ///< from the link to the root or the other link
    double reach = 0;            ///< metres between the link's origin and its farthest point
  };
  /// A link with an obstacle, or with another link.
  struct Pair {
    std::size_t mover = 0;
    const ObstacleShape* obstacle = nullptr;
    LinkPair links;  ///< of a pair with an obstacle the first alone
  };
  struct Motion {
    const Configuration &from, &delta;
    std::int64_t steps = 0;
    std::vector<double> lengths;  ///< of the way of each mover, at most; metres
  };

  void add_mover(int link, std::optional<int> seen_from);
  [[nodiscard]] double gap(const PosedLinks& posed, const Pair& pair, double enough) const;
  [[nodiscard]] bool are_free(const Motion& motion, std::int64_t first, std::int64_t last,
                              const std::vector<const Pair*>& pairs) const;

  const Robot& robot_;
  LinkDistances links_;
  std::vector<ObstacleShape> obstacles_;
  std::vector<Mover> movers_;
  std::vector<Pair> pairs_;
};

StateCheck::StateCheck(const Robot& robot, const Scene& scene)
    : robot_(robot), links_(robot), obstacles_(internal::obstacle_shapes(robot, scene)) {
  for (int link = 0; link < links_.link_count(); ++link) {
    if (links_.shapes(link).empty() || !links_.is_moving(link)) continue;
    add_mover(link, std::nullopt);
    for (const ObstacleShape& obstacle : obstacles_) {
      if (std::ranges::count(obstacle.may_touch, link) > 0) continue;
      pairs_.push_back({movers_.size() - 1, &obstacle, {link, -1}});
    }
  }
  for (const LinkPair& links : internal::link_pairs(robot, scene)) {
    if (links_.shapes(links.first).empty() || links_.shapes(links.second).empty()) continue;
    add_mover(links.first, links.second);
    pairs_.push_back({movers_.size() - 1, nullptr, links});
  }
}

void StateCheck::add_mover(int link, std::optional<int> seen_from) {
  const Sphere bound = internal::bound_of(links_.shapes(link));
  movers_.push_back({{robot_, link, seen_from}, bound.center.norm() + bound.radius});
}

/// Metres between a pair. Exact up to `enough`, otherwise any larger value; a lower bound where the
/// spheres of a pair that is checked by exact geometry are apart. Negative in contact.
double StateCheck::gap(const PosedLinks& posed, const Pair& pair, double enough) const {
  const auto& [first, second, is_exact] = pair.links;
  if (pair.obstacle == nullptr) {
    const double spheres = links_.between_spheres(posed, first, second, enough);
    return spheres < 0 ? links_.between(posed, pair.links, enough) : spheres;
  }
  const double spheres = links_.between_spheres(posed, first, *pair.obstacle, enough);
  return spheres < 0 ? links_.between(posed, first, *pair.obstacle, enough) : spheres;
}

bool StateCheck::is_free(const Configuration& from, const Configuration& delta,
                         std::int64_t steps) const {
  constexpr double kRounding = 1e-6;  // metres; bounds take values in single precision
  const std::vector<float> begin(from.begin(), from.end()), change(delta.begin(), delta.end());
  Motion motion{from, delta, steps, {}};
  for (const Mover& mover : movers_) {
    const internal::MotionBound bound = internal::ChainMotion(mover.chain, begin, change).of_a;
    motion.lengths.push_back(bound.speed + bound.speed_by_reach * mover.reach + kRounding);
  }
  std::vector<const Pair*> pairs;
  for (const Pair& pair : pairs_) pairs.push_back(&pair);
  return are_free(motion, 1, steps, pairs);
}

/// Checks the states `first` to `last`, the middle one before its halves.
bool StateCheck::are_free(const Motion& motion, std::int64_t first, std::int64_t last,
                          const std::vector<const Pair*>& pairs) const {
  if (first > last || pairs.empty()) return true;
  internal::poll_interrupt();
  const auto share = [&](std::int64_t steps) {
    return static_cast<double>(steps) / static_cast<double>(motion.steps);
  };
  const std::int64_t middle = first + (last - first) / 2;
  Configuration q = motion.from;
  for (std::size_t j = 0; j < q.size(); ++j) q[j] += share(middle) * motion.delta[j];
  const PosedLinks posed = links_.posed(robot_.link_poses(q));
  const double farthest = share(std::max(middle - first, last - middle));
  std::vector<const Pair*> near;
  for (const Pair* pair : pairs) {
    const double enough = farthest * motion.lengths[pair->mover];
    // Many shapes of two links are within a long reach of each other.
    constexpr double kLinkReach = 0.05;
    const double reach = pair->obstacle != nullptr ? enough : std::min(enough, kLinkReach);
    const double distance = gap(posed, *pair, reach);
    if (distance < 0) return false;
    if (distance <= reach || reach < enough) near.push_back(pair);
  }
  return are_free(motion, first, middle - 1, near) && are_free(motion, middle + 1, last, near);
}

}  // namespace

bool is_path_free(const Robot& robot, const Scene& scene, const std::vector<Configuration>& path,
                  double resolution) {
  if (path.empty() || !(resolution > 0)) return false;
  for (const Configuration& q : path) {
    if (!robot.is_configuration(q)) return false;
  }
  const StateCheck check(robot, scene);
  const Configuration still(path.front().size(), 0.0);
  if (!check.is_free(path.front(), still, 1)) return false;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const std::int64_t steps = step_count(robot.distance(path[i - 1], path[i]), resolution);
    if (!check.is_free(path[i - 1], robot.difference(path[i - 1], path[i]), steps)) return false;
  }
  return true;
}

double tilt(const Robot& robot, const OrientationConstraint& constraint,
            std::span<const double> q) {
  const Transform X_RL = robot.link_poses(q)[as_index(*robot.find_link(constraint.link))];
  const Vec3 axis = X_RL.rotation * constraint.axis;
  return std::atan2(axis.cross(constraint.up).norm(), axis.dot(constraint.up));
}

double largest_tilt(const Robot& robot, const OrientationConstraint& constraint,
                    const std::vector<Configuration>& path, double resolution) {
  if (!(resolution > 0)) return std::numeric_limits<double>::infinity();
  double largest = 0;
  visit_states(robot, path, resolution, [&](const Configuration& q) {
    const double now = tilt(robot, constraint, q);
    largest = std::isnan(now) ? std::numeric_limits<double>::infinity() : std::max(largest, now);
    return !std::isnan(now);
  });
  return largest;
}

}  // namespace mneme
