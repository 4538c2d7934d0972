// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "path/sweep.h"

#include "base/as_index.h"
#include "robot/kinematics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

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
    const auto i = as_index(joint);
    const bool slides = robot.joints()[i].type == JointType::prismatic;
    ways[i] = std::abs(to[i] - from[i]) * (slides ? 1 : reach);
    if (slides) reach += std::max(std::abs(from[i]), std::abs(to[i]));
    reach += robot.joints()[i].origin.translation.norm();
    joint = robot.links()[as_index(robot.joints()[i].parent_link)].parent_joint;
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
    : robot_(robot), margin_(margin), links_(robot), obstacles_(obstacle_shapes(scene)) {
  const int links = links_.link_count();
  for (int link = 0; link < links; ++link) reaches_.push_back(reach_of(links_.shapes(link)));
  for (const auto& [first, second] : robot.self_pairs()) {
    pairs_.push_back({first, second, links + static_cast<int>(pairs_.size()), -1});
  }
  for (int link = 0; link < links; ++link) {
    if (links_.shapes(link).empty()) continue;
    for (int shape = 0; shape < static_cast<int>(obstacles_.size()); ++shape) {
      pairs_.push_back({link, link, link, shape});
    }
  }
}

double Sweep::clearance(const Pair& pair, const PosedLinks& posed, double enough) const {
  if (pair.obstacle < 0) return links_.between(posed, pair.link, pair.other_link, enough);
  const ObstacleShape& obstacle = obstacles_[as_index(pair.obstacle)];
  return links_.between(posed, pair.link, obstacle, enough + margin_) - margin_;
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
    for (std::size_t i = 0; i < sweep.reaches_.size(); ++i) {
      ways.push_back(ways_of(robot, i, sweep.reaches_[i], begin, end));
      speeds_.push_back(std::accumulate(ways[i].begin(), ways[i].end(), 0.0));
    }
    for (const auto& [first, second] : robot.self_pairs()) {
      speeds_.push_back(approach_of(ways[as_index(first)], ways[as_index(second)]));
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
    const PosedLinks posed = sweep_.links_.posed(sweep_.robot_.link_poses(at(middle)));
    std::vector<Pair> undecided;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (i % kPairsPerStop == 0 && must_stop_ && must_stop_()) return false;
      const double approach = half * speeds_[as_index(pairs[i].speed)];
      if (approach == 0) continue;
      const double clearance = sweep_.clearance(pairs[i], posed, approach);
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
