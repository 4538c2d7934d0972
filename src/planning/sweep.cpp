// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/sweep.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "robot/link_shapes.h"

namespace mneme::internal {
namespace {

/// How far the shapes of `link` can be from the axis of each joint that carries it; 0 for others.
/// A sliding joint carries them as far as it moves itself.
std::vector<double> reaches_of(const Robot& robot, std::size_t link,
                               std::span<const Capsule> shapes) {
  std::vector<double> reaches(robot.joints().size(), 0.0);
  double distance = 0;
  for (const Capsule& shape : shapes) {
    distance = std::max(distance, std::max(shape.a.norm(), shape.b.norm()) + shape.radius);
  }
  for (int i = robot.links()[link].parent_joint; i >= 0;) {
    const auto index = static_cast<std::size_t>(i);
    const Joint& joint = robot.joints()[index];
    const bool slides = joint.type == JointType::prismatic;
    reaches[index] = slides ? 1 : distance;
    if (slides) distance += std::max(std::abs(joint.lower), std::abs(joint.upper));
    distance += joint.origin.translation.norm();
    i = robot.links()[static_cast<std::size_t>(joint.parent_link)].parent_joint;
  }
  return reaches;
}

/// Joints that carry both links do not change where one is seen from the other.
std::vector<double> apart(std::vector<double> a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] = a[i] > 0 && b[i] > 0 ? 0 : a[i] + b[i];
  return a;
}

/// How far each joint turns, those that follow others too.
std::vector<double> turns_of(const Robot& robot, std::span<const double> delta) {
  std::vector<double> turns(robot.joints().size(), 0.0);
  for (std::size_t i = 0; i < delta.size(); ++i) {
    turns[static_cast<std::size_t>(robot.group()[i])] = std::abs(delta[i]);
  }
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const auto& mimic = robot.joints()[i].mimic;
    if (!mimic) continue;
    turns[i] = std::abs(mimic->multiplier) * turns[static_cast<std::size_t>(mimic->joint)];
  }
  return turns;
}

}  // namespace

Sweep::Sweep(const Robot& robot, const Scene& scene, double margin)
    : robot_(robot), margin_(margin) {
  for (std::size_t i = 0; i < robot.links().size(); ++i) {
    std::vector<Capsule> capsules = shapes_of(robot.links()[i]);
    const Sphere bound = bound_of(capsules);
    reaches_.push_back(reaches_of(robot, i, capsules));
    links_.push_back({std::move(capsules), bound});
  }
  for (const auto& [first, second] : robot.self_pairs()) {
    const auto a = static_cast<std::size_t>(first), b = static_cast<std::size_t>(second);
    pairs_.push_back({a, b, nullptr, reaches_.size()});
    reaches_.push_back(apart(reaches_[a], reaches_[b]));
  }
  for (std::size_t i = 0; i < links_.size(); ++i) {
    if (links_[i].capsules.empty()) continue;
    for (const Obstacle& obstacle : scene.obstacles) {
      for (const Shape& shape : obstacle.shapes) pairs_.push_back({i, i, &shape, i});
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
  const LinkShapes& link = links_[pair.link];
  const Transform& X_WL = poses[pair.link];
  if (pair.shape != nullptr) return clearance(link, X_WL, *pair.shape, enough + margin_) - margin_;
  return clearance(link, X_WL, links_[pair.other_link], poses[pair.other_link], enough);
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
    const std::vector<double> turns = turns_of(sweep.robot_, delta_);
    std::vector<double> speeds;
    for (const std::vector<double>& reaches : sweep.reaches_) {
      speeds.push_back(std::inner_product(turns.begin(), turns.end(), reaches.begin(), 0.0));
    }
    for (const Pair& pair : sweep.pairs_) {
      if (speeds[pair.reaches] > 0) pairs_.push_back({&pair, speeds[pair.reaches]});
    }
  }

  [[nodiscard]] bool is_free() const { return is_part_free(0.5, 0.5, pairs_); }

 private:
  /// Whether `pairs` stay apart from `middle` - `half` to `middle` + `half`; 1 is the whole motion.
  [[nodiscard]] bool is_part_free(double middle, double half,
                                  const std::vector<MovingPair>& pairs) const {
    if (must_stop_ && must_stop_()) return false;
    Configuration q(from_.begin(), from_.end());
    for (std::size_t i = 0; i < q.size(); ++i) q[i] += middle * delta_[i];
    const std::vector<Transform> poses = sweep_.robot_.link_poses(q);
    std::vector<MovingPair> undecided;
    for (const MovingPair& moving : pairs) {
      const double approach = half * moving.speed;
      const double clearance = sweep_.clearance(*moving.pair, poses, approach);
      if (clearance < -kTolerance) return false;
      if (clearance <= approach && approach > kTolerance) undecided.push_back(moving);
    }
    return undecided.empty() || (is_part_free(middle - 0.5 * half, 0.5 * half, undecided) &&
                                 is_part_free(middle + 0.5 * half, 0.5 * half, undecided));
  }

  const Sweep& sweep_;
  std::span<const double> from_;
  Configuration delta_;
  const std::function<bool()>& must_stop_;
  std::vector<MovingPair> pairs_;
};

bool Sweep::is_free(std::span<const double> from, std::span<const double> to,
                    const std::function<bool()>& must_stop) const {
  return Motion(*this, from, to, must_stop).is_free();
}

}  // namespace mneme::internal
