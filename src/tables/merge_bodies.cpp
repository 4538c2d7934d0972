// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tables/merge_bodies.h"

#include "base/threads.h"
#include "tables/shape_groups.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace mneme::internal {
namespace {

/// Typical travel of a body's ball, metres, over the states that are checked together. The number
/// of obstacles that it meets depends on the ball's radius and on this.
constexpr double kSweep = 0.15;
/// Two bodies are merged if their common ball sweeps at most this multiple of their own volumes.
constexpr double kMergeRatio = 1.0;

double swept_volume(const Sphere& ball) { return std::pow(ball.radius + kSweep, 3); }

/// Keeps the nearest later body of each body.
class BodyMerger {
 public:
  explicit BodyMerger(std::vector<Body>& bodies)
      : bodies_(bodies), nearest_(bodies.size()), is_gone_(bodies.size()), count_(bodies.size()) {
    for (const Body& body : bodies) volumes_.push_back(swept_volume(body.ball));
    for (std::size_t i = 0; i < bodies.size(); ++i) find_nearest(i);
  }

  void run(std::size_t most) {
    while (merge_closest(count_ > most ? kInfinity : kMergeRatio)) continue;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (is_gone_[i]) continue;
      if (kept != i) bodies_[kept] = std::move(bodies_[i]);
      ++kept;
    }
    bodies_.resize(kept);
  }

 private:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  /// The later body whose merger has the least ratio, the first of equals.
  struct Nearest {
    double ratio = kInfinity;
    std::size_t other = kNone;
    bool is_bound = false;  ///< the ratio is a lower bound, and `other` is unknown
  };

  /// The volume of the common ball, as a multiple of the bodies' own volumes.
  [[nodiscard]] double ratio_of(std::size_t i, std::size_t k) const {
    return swept_volume(enclosing_ball(bodies_[i].ball, bodies_[k].ball)) /
           (volumes_[i] + volumes_[k]);
  }

  void find_nearest(std::size_t i) {
    poll_interrupt();
    Nearest& nearest = nearest_[i];
    nearest = {};
    for (std::size_t k = i + 1; k < bodies_.size(); ++k) {
      if (is_gone_[k] || bodies_[i].frame != bodies_[k].frame) continue;
      const double ratio = ratio_of(i, k);
      if (ratio < nearest.ratio) nearest = {ratio, k};
    }
  }

  /// The first body with the least ratio below `limit`, or kNone.
  std::size_t find_closest(double limit) {
    while (true) {
      std::size_t closest = kNone;
      double least = limit;
      for (std::size_t i = 0; i < bodies_.size(); ++i) {
        if (is_gone_[i] || !(nearest_[i].ratio < least)) continue;
        least = nearest_[i].ratio;
        closest = i;
      }
      if (closest == kNone || !nearest_[closest].is_bound) return closest;
      find_nearest(closest);
    }
  }

  bool merge_closest(double limit) {
    const std::size_t first = find_closest(limit);
    if (first == kNone) return false;
    const std::size_t second = nearest_[first].other;
    Body &kept = bodies_[first], &other = bodies_[second];
    kept.ball = enclosing_ball(kept.ball, other.ball);
    kept.links.insert(kept.links.end(), other.links.begin(), other.links.end());
    volumes_[first] = swept_volume(kept.ball);
    is_gone_[second] = true;
    --count_;
    find_nearest(first);
    for (std::size_t i = 0; i < second; ++i) {
      if (i != first && !is_gone_[i] && bodies_[i].frame == kept.frame) update(i, first, second);
    }
    return true;
  }

  /// Updates the nearest body of body `i` after `second` has become a part of `first`.
  void update(std::size_t i, std::size_t first, std::size_t second) {
    Nearest& nearest = nearest_[i];
    const bool is_lost = !nearest.is_bound && (nearest.other == first || nearest.other == second);
    if (i < first) {
      const double ratio = ratio_of(i, first);
      // Others of the same ratio stand behind `nearest.other`.
      const bool is_first_equal =
          ratio == nearest.ratio && !nearest.is_bound && first <= nearest.other;
      if (ratio < nearest.ratio || is_first_equal) {
        nearest = {ratio, first};
        return;
      }
    }
    if (is_lost) nearest.is_bound = true;
  }

  std::vector<Body>& bodies_;
  std::vector<double> volumes_;
  std::vector<Nearest> nearest_;
  std::vector<bool> is_gone_;  ///< merged into an earlier body
  std::size_t count_;
};

}  // namespace

void merge_bodies(std::vector<Body>& bodies, std::size_t most) { BodyMerger(bodies).run(most); }

}  // namespace mneme::internal
