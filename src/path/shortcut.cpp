// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "path/shortcut.h"

#include "mneme/path.h"

#include "path/path_conversion.h"
#include "path/verify.h"
#include "robot/joint_space.h"

#include <algorithm>
#include <optional>

namespace mneme {
namespace {

/// A point of a path: `fraction` of the way along motion `motion`.
struct PathPoint {
  std::size_t motion = 0;
  float fraction = 0;
};

class Shortcutter {
 public:
  Shortcutter(const CollisionChecker& checker, Path& path, const internal::MotionVerifier* verifier,
              CheckCounters& counters)
      : checker_(checker),
        path_(path),
        space_(checker.robot()),
        verifier_(verifier),
        counters_(counters) {
    for (const Configuration& q : path) nodes_.push_back(internal::to_floats(q));
    measure();
  }

  /// Drops every waypoint that a straight motion between its neighbours can replace.
  void drop_waypoints(const std::function<bool()>& must_stop) {
    for (std::size_t i = 1; i + 1 < nodes_.size() && !must_stop();) {
      const bool is_at_end = i == 1 || i + 2 == nodes_.size();
      if (is_free(nodes_[i - 1], nodes_[i + 1], is_at_end)) {
        erase_between(i - 1, i + 1);
      } else {
        ++i;
      }
    }
    measure();
  }

  /// Tries one shortcut between two random points of the path; true if that shortens it by at least
  /// `least_gain` of its length.
  bool attempt(Rng& rng, float least_gain) {
    float first = static_cast<float>(rng.uniform()) * total_;
    float second = static_cast<float>(rng.uniform()) * total_;
    if (first > second) std::swap(first, second);
    const PathPoint a = locate(first), b = locate(second);
    if (a.motion == b.motion) return false;
    const std::vector<float> q_a = point_at(a), q_b = point_at(b);
    const float direct = space_.difference(q_a.data(), q_b.data(), delta_.data());
    if (second - first - direct < least_gain * total_) return false;
    // Neither point is an end of the path but by rare chance, so both remaining halves keep their
    // margins.
    // A motion that was checked may touch something between the states that were looked at.
    if (!is_state_free(q_a) || !is_free(q_a, q_b, false)) return false;
    nodes_[a.motion + 1] = q_a;
    if (b.motion == a.motion + 1) {
      nodes_.insert(nodes_.begin() + static_cast<std::ptrdiff_t>(b.motion) + 1, q_b);
    } else {
      nodes_[b.motion] = q_b;
      erase_between(a.motion + 1, b.motion);
    }
    measure();
    return true;
  }

  void store() {
    Path result = internal::to_path(checker_.robot(), nodes_);
    result.front() = path_.front();
    result.back() = path_.back();
    path_ = std::move(result);
  }

 private:
  bool is_free(std::span<const float> from, std::span<const float> to, bool is_at_end) {
    return checker_.is_motion_valid(from, to, counters_) &&
           (verifier_ == nullptr || verifier_->is_free(from, to, is_at_end, counters_));
  }

  bool is_state_free(std::span<const float> q) {
    ++counters_.states;
    return checker_.is_valid(q);
  }

  void erase_between(std::size_t first, std::size_t last) {
    nodes_.erase(nodes_.begin() + static_cast<std::ptrdiff_t>(first) + 1,
                 nodes_.begin() + static_cast<std::ptrdiff_t>(last));
  }

  void measure() {
    lengths_.clear();
    total_ = 0;
    delta_.resize(nodes_.front().size());
    for (std::size_t i = 0; i + 1 < nodes_.size(); ++i) {
      lengths_.push_back(space_.difference(nodes_[i].data(), nodes_[i + 1].data(), delta_.data()));
      total_ += lengths_.back();
    }
  }

  PathPoint locate(float distance) const {
    std::size_t motion = 0;
    while (motion + 1 < lengths_.size() && distance > lengths_[motion])
      distance -= lengths_[motion++];
    const float length = lengths_[motion];
    return {motion, length > 0 ? std::clamp(distance / length, 0.0f, 1.0f) : 0.0f};
  }

  std::vector<float> point_at(const PathPoint& point) {
    const std::vector<float>& from = nodes_[point.motion];
    space_.difference(from.data(), nodes_[point.motion + 1].data(), delta_.data());
    std::vector<float> q(from.size());
    for (std::size_t j = 0; j < q.size(); ++j) {
      q[j] = space_.into_limits(static_cast<int>(j), from[j] + point.fraction * delta_[j]);
    }
    return q;
  }

  const CollisionChecker& checker_;
  Path& path_;
  internal::JointSpace space_;
  const internal::MotionVerifier* verifier_;
  CheckCounters& counters_;
  std::vector<std::vector<float>> nodes_;
  std::vector<float> lengths_, delta_;
  float total_ = 0;
};

}  // namespace

double path_length(const Robot& robot, const Path& path) {
  double length = 0;
  for (std::size_t i = 1; i < path.size(); ++i) length += robot.distance(path[i - 1], path[i]);
  return length;
}

void internal::shortcut_until(const CollisionChecker& checker, Path& path, std::uint64_t seed,
                              ShortcutEffort effort, const MotionVerifier* verifier,
                              CheckCounters& counters, const std::function<bool()>& must_stop) {
  if (path.size() < 3) return;
  Shortcutter shortcutter(checker, path, verifier, counters);
  shortcutter.drop_waypoints(must_stop);
  Rng rng(seed);
  for (int i = 0, idle = 0; i < effort.attempts && idle < effort.patience && !must_stop(); ++i) {
    idle = shortcutter.attempt(rng, effort.least_gain) ? 0 : idle + 1;
  }
  shortcutter.drop_waypoints(must_stop);
  shortcutter.store();
}

void shortcut(const CollisionChecker& checker, Path& path, std::uint64_t seed, int attempts,
              Verification verification, CheckCounters& counters) {
  std::optional<internal::MotionVerifier> verifier;
  if (verification != Verification::none) verifier.emplace(checker, verification);
  internal::shortcut_until(checker, path, seed, {attempts, attempts, 0},
                           verifier ? &*verifier : nullptr, counters, [] { return false; });
}

}  // namespace mneme
