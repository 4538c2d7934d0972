// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/warp_paths.h"

#include <cmath>

#include "robot/joint_space.h"

namespace mneme::internal {
namespace {

class PathWarper {
 public:
  PathWarper(const Robot& robot, std::span<const double> start, std::span<const double> goal)
      : space_(robot),
        joints_(static_cast<std::size_t>(robot.joint_count())),
        start_(start.begin(), start.end()),
        goal_(goal.begin(), goal.end()),
        start_shift_(joints_),
        goal_shift_(joints_),
        delta_(joints_) {}

  void add(std::span<const float> path, std::vector<float>& means) {
    const std::size_t count = path.size() / joints_;
    if (count < 3) return;
    const float* first = path.data();
    const float* last = path.data() + (count - 1) * joints_;
    const bool is_reversed = distance(first, goal_) + distance(last, start_) <
                             distance(first, start_) + distance(last, goal_);
    space_.difference(first, (is_reversed ? goal_ : start_).data(), start_shift_.data());
    space_.difference(last, (is_reversed ? start_ : goal_).data(), goal_shift_.data());
    measure(path, count);
    for (std::size_t i = 1; i + 1 < count; ++i) {
      const float* q = path.data() + i * joints_;
      const float fraction = lengths_[i] / lengths_.back();
      for (std::size_t j = 0; j < joints_; ++j) {
        const float shift = fraction * goal_shift_[j] + (1 - fraction) * start_shift_[j];
        means.push_back(space_.into_limits(static_cast<int>(j), q[j] + shift));
      }
      means.insert(means.end(), q, q + joints_);
    }
  }

 private:
  float distance(const float* a, const std::vector<float>& b) {
    return space_.difference(a, b.data(), delta_.data());
  }

  /// Arc lengths from the path's start to each waypoint.
  void measure(std::span<const float> path, std::size_t count) {
    lengths_.assign(count, 0);
    for (std::size_t i = 1; i < count; ++i) {
      const float* q = path.data() + i * joints_;
      lengths_[i] = lengths_[i - 1] + space_.difference(q - joints_, q, delta_.data());
    }
    lengths_.back() = std::max(lengths_.back(), kLeastLength);
  }

  static constexpr float kLeastLength = 1e-6f;
  JointSpace space_;
  std::size_t joints_;
  std::vector<float> start_, goal_, start_shift_, goal_shift_, delta_, lengths_;
};

}  // namespace

GaussianMixture warp_paths(const Robot& robot, const Configuration& start,
                           std::span<const Configuration> goals,
                           std::span<const PrimitiveRetrieval> retrievals) {
  GaussianMixture mixture;
  mixture.joint_count = robot.joint_count();
  std::size_t size = 0;
  for (const PrimitiveRetrieval& retrieval : retrievals) {
    for (const Match& match : retrieval.matches) {
      size += 2 * match.experience->sampler.means.size();
    }
  }
  mixture.means.reserve(size);
  mixture.origins.reserve(size / static_cast<std::size_t>(robot.joint_count()));
  for (std::size_t i = 0; i < retrievals.size(); ++i) {
    PathWarper warper(robot, start, goals[i]);
    for (const Match& match : retrievals[i].matches) {
      warper.add(match.experience->sampler.means, mixture.means);
    }
    mixture.origins.resize(static_cast<std::size_t>(mixture.component_count()),
                           static_cast<Origin>(i));
  }
  return mixture;
}

}  // namespace mneme::internal
