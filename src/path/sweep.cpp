// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "path/sweep.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "robot/kinematics.h"
#include "robot/link_shapes.h"

namespace mneme::internal {
namespace {

/// Between two looks at the clock; about as much work as a state of an ordinary scene.
constexpr std::size_t kPairsPerStop = 1000;

using JointValues = std::vector<double>;

double reach_of(std::span<const Capsule> capsules) {
  double reach = 0;
  for (const Capsule& shape : capsules) {
    reach = std::max(reach, std::max(shape.a.norm(), shape.b.norm()) + shape.radius);
  }
  return reach;
}

/// Metres by which each joint can move a point of `link` while the joints go from one set of values
/// to the other. A turning joint moves it along an arc about its axis, which is no farther from it
/// than the links and slides between them are long.
std::vector<double> ways_of(const Robot& robot, std::size_t link, double reach,
                            const JointValues& from, const JointValues& to) {
  std::vector<double> ways(robot.joints().size(), 0.0);
  for (int joint = robot.links()[link].parent_joint; joint >= 0;) {
    const auto i = static_cast<std::size_t>(joint);
    const bool slides = robot.joints()[i].type == JointType::prismatic;
    ways[i] = std::abs(to[i] - from[i]) * (slides ? 1 : reach);
    if (slides) reach += std::max(std::abs(from[i]), std::abs(to[i]));
    reach += robot.joints()[i].origin.translation.norm();
    joint = robot.links()[static_cast<std::size_t>(robot.joints()[i].parent_link)].parent_joint;
  }
  return ways;
}

/// Joints that carry both links do not change where one is seen from the other.
double approach_of(const std::vector<double>& first, const std::vector<double>& second) {
  double sum = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (first[i] == 0 || second[i] == 0) sum += first[i] + second[i];
  }
  return sum;
}

}  // namespace

Sweep::Sweep(const Robot& robot, const Scene& scene, double margin)
    : robot_(robot), margin_(margin) {
  for (const Link& link : robot.links()) {
    std::vector<Capsule> capsules = shapes_of(link);
    const Sphere bound = bound_of(capsules);
    const double reach = reach_of(capsules);
    links_.push_back({std::move(capsules), bound, reach});
  }
  const int links = static_cast<int>(links_.size());
  for (const auto& [first, second] : robot.self_pairs()) {
    pairs_.push_back({first, second, links + static_cast<int>(pairs_.size()), nullptr});
  }
  for (int link = 0; link < links; ++link) {
    if (links_[static_cast<std::size_t>(link)].capsules.empty()) continue;
    for (const Obstacle& obstacle : scene.obstacles) {
      for (const Shape& shape : obstacle.shapes) pairs_.push_back({link, link, link, &shape});
    }
  }
}

double Sweep::clearance(const LinkShapes& link, const Transform& X_WL, const Shape& shape,
                        double enough) {
  const Vec3 center = X_WL * link.bound.center;
  const double bound = distance_to_segment(center, center, shape) - link.bound.radius;
  if (bound > enough) return bound;
  double least = std::numeric_limits<double>::infinity();
  for (const Capsule& own : link.capsules) {
    const double between = distance_to_segment(X_WL * own.a, X_WL * own.b, shape);
    least = std::min(least, between - own.radius);
  }
  return least;
}

double Sweep::clearance(const LinkShapes& first, const Transform& X_WF, const LinkShapes& second,
                        const Transform& X_WS, double enough) {
  const double bound = (X_WF * first.bound.center - X_WS * second.bound.center).norm() -
                       first.bound.radius - second.bound.radius;
  if (bound > enough) return bound;
  double least = std::numeric_limits<double>::infinity();
  for (const Capsule& p : first.capsules) {
    const Vec3 a = X_WF * p.a, b = X_WF * p.b;
    for (const Capsule& q : second.capsules) {
      const double between = segment_distance(a, b, X_WS * q.a, X_WS * q.b);
      least = std::min(least, between - p.radius - q.radius);
    }
  }
  return least;
}

double Sweep::clearance(const Pair& pair, std::span<const Transform> poses, double enough) const {
  const auto first = static_cast<std::size_t>(pair.link);
  const auto second = static_cast<std::size_t>(pair.other_link);
  if (pair.shape != nullptr) {
    return clearance(links_[first], poses[first], *pair.shape, enough + margin_) - margin_;
  }
  return clearance(links_[first], poses[first], links_[second], poses[second], enough);
}

/// One motion while it is halved.
class Sweep::Motion {
 public:
  Motion(const Sweep& sweep, std::span<const double> from, std::span<const double> to,
         const std::function<bool()>& must_stop)
      : sweep_(sweep),
        from_(from),
        delta_(sweep.robot_.difference(from, to)),
        must_stop_(must_stop) {
    const Robot& robot = sweep.robot_;
    const JointValues begin = joint_values(robot.joints(), robot.group(), from);
    const JointValues end = joint_values(robot.joints(), robot.group(), at(1));
    std::vector<std::vector<double>> ways;
    for (std::size_t i = 0; i < sweep.links_.size(); ++i) {
      ways.push_back(ways_of(robot, i, sweep.links_[i].reach, begin, end));
      speeds_.push_back(std::accumulate(ways[i].begin(), ways[i].end(), 0.0));
    }
    for (const auto& [first, second] : robot.self_pairs()) {
      speeds_.push_back(approach_of(ways[static_cast<std::size_t>(first)],
                                    ways[static_cast<std::size_t>(second)]));
    }
  }

  [[nodiscard]] bool is_free() const { return is_part_free(0.5, 0.5, sweep_.pairs_); }

 private:
  [[nodiscard]] Configuration at(double fraction) const {
    Configuration q(from_.begin(), from_.end());
    for (std::size_t i = 0; i < q.size(); ++i) q[i] += fraction * delta_[i];
    return q;
  }

  /// Whether `pairs` stay apart from `middle` - `half` to `middle` + `half`; 1 is the whole motion.
  [[nodiscard]] bool is_part_free(double middle, double half, std::span<const Pair> pairs) const {
    const std::vector<Transform> poses = sweep_.robot_.link_poses(at(middle));
    std::vector<Pair> undecided;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (i % kPairsPerStop == 0 && must_stop_ && must_stop_()) return false;
      const double approach = half * speeds_[static_cast<std::size_t>(pairs[i].speed)];
      if (approach == 0) continue;
      const double clearance = sweep_.clearance(pairs[i], poses, approach);
      // Half for what the middle may overlap, half for what is left of the way.
      if (clearance < -0.5 * kTolerance) return false;
      if (clearance <= approach && approach > 0.5 * kTolerance) undecided.push_back(pairs[i]);
    }
    return undecided.empty() || (is_part_free(middle - 0.5 * half, 0.5 * half, undecided) &&
                                 is_part_free(middle + 0.5 * half, 0.5 * half, undecided));
  }

  const Sweep& sweep_;
  std::span<const double> from_;
  Configuration delta_;
  const std::function<bool()>& must_stop_;
  std::vector<double> speeds_;  ///< metres over the whole motion: of links, then of pairs of links
};

bool Sweep::is_free(std::span<const double> from, std::span<const double> to,
                    const std::function<bool()>& must_stop) const {
  return Motion(*this, from, to, must_stop).is_free();
}

}  // namespace mneme::internal
