// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Builds threaded configurations link by link, within joint limits. Links before the gap get random
// directions that keep it within reach. The two links into the gap reach a random point of it by
// two-link inverse kinematics. Links behind it are random.
#include "memory/planar_chain.h"
#include "robot/kinematics.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

namespace mneme {
namespace internal {
namespace {

constexpr int kTriesPerLink = 8;

class ThreadedBuilder {
 public:
  ThreadedBuilder(const PlanarChain& chain, const PrimitiveKey& key, Rng& rng)
      : chain_(chain), key_(key), gap_(gap_segment(key)), rng_(rng) {}

  /// Directions of all links, or nothing if this attempt failed.
  std::optional<std::vector<double>> build(int first_link) {
    points_.assign(1, Vec2::Zero());
    directions_.clear();
    target_ = gap_.a + rng_.uniform() * (gap_.b - gap_.a);
    entry_length_ = rng_.uniform() * chain_.length(first_link);
    double rest = entry_length_;
    for (int link = 1; link < first_link; ++link) rest += chain_.length(link);
    for (int link = 0; link + 1 < first_link; ++link) {
      if (!add_leading_link(rest)) return std::nullopt;
      rest -= chain_.length(link + 1);
    }
    if (!(first_link == 0 ? aim_one_link() : aim_two_links())) return std::nullopt;
    for (int link = first_link + 1; link < chain_.link_count(); ++link) {
      if (!add_trailing_link()) return std::nullopt;
    }
    return directions_;
  }

 private:
  [[nodiscard]] int next_link() const { return static_cast<int>(directions_.size()); }
  [[nodiscard]] double last_direction() const {
    return directions_.empty() ? 0 : directions_.back();
  }

  /// A random direction of the next link, within `window` of `toward` or within its joint limits,
  /// whichever range is narrower.
  double sample_direction(double toward, double window) {
    const Limits& limits = chain_.limits(next_link());
    if (limits.width() >= 2 * window) return toward + rng_.uniform(-window, window);
    const double value = rng_.uniform(limits.lower, limits.upper);
    return chain_.direction(next_link(), value, last_direction());
  }

  /// Appends a link if its joint is within limits, it is outside both circles, crosses no link
  /// except its neighbour, and crosses the gap only if `may_cross`.
  bool add_link(double direction, bool may_cross) {
    const int link = next_link();
    const double value = chain_.joint_value(link, direction, last_direction());
    if (!chain_.limits(link).contains(value)) return false;
    const Vec2 from = points_.back();
    const Vec2 to = from + chain_.length(link) * Vec2(std::cos(direction), std::sin(direction));
    if (hits_circle(from, to, 0) || hits_circle(from, to, 3)) return false;
    if (!may_cross && do_segments_cross(from, to, gap_.a, gap_.b)) return false;
    for (std::size_t i = 0; i + 2 < points_.size(); ++i) {
      if (do_segments_cross(from, to, points_[i], points_[i + 1])) return false;
    }
    directions_.push_back(direction);
    points_.push_back(to);
    return true;
  }

  /// Appends a link that does not cross the gap and ends at most `rest` from the target.
  bool add_leading_link(double rest) {
    const Vec2 to_target = target_ - points_.back();
    const double distance = to_target.norm();
    const double length = chain_.length(next_link());
    // Cosine rule: above 1 no direction works, below -1 any does.
    const double cosine =
        (distance * distance + length * length - rest * rest) / (2 * distance * length);
    if (cosine >= 1) return false;
    const double window = std::acos(std::max(-1.0, cosine));
    const double toward = std::atan2(to_target.y(), to_target.x());
    for (int i = 0; i < kTriesPerLink; ++i) {
      const double direction = sample_direction(toward, window);
      if (std::abs(std::remainder(direction - toward, 2 * std::numbers::pi)) > window) continue;
      if (add_link(direction, false)) return true;
    }
    return false;
  }

  bool add_trailing_link() {
    for (int i = 0; i < kTriesPerLink; ++i) {
      if (add_link(sample_direction(0, std::numbers::pi), true)) return true;
    }
    return false;
  }

  bool hits_circle(const Vec2& from, const Vec2& to, std::size_t circle) const {
    const Vec2 center(key_[circle], key_[circle + 1]);
    const Vec2 along = to - from;
    const double t = std::clamp((center - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
    return (from + t * along - center).norm() <= key_[circle + 2];
  }

  bool aim_one_link() {
    if (target_.norm() > chain_.length(0)) return false;
    return add_link(std::atan2(target_.y(), target_.x()), true);
  }

  /// The link before the gap, then the first one through it.
  bool aim_two_links() {
    const Vec2 to_target = target_ - points_.back();
    const double distance = to_target.norm();
    const double a = chain_.length(next_link()), b = entry_length_;
    if (distance >= a + b || distance <= std::abs(a - b)) return false;
    const double toward = std::atan2(to_target.y(), to_target.x());
    const double shoulder = std::acos((a * a + distance * distance - b * b) / (2 * a * distance));
    const double direction = toward + (rng_.index(2) == 0 ? shoulder : -shoulder);
    if (!add_link(direction, false)) return false;
    const Vec2 rest = target_ - points_.back();
    return add_link(std::atan2(rest.y(), rest.x()), true);
  }

  const PlanarChain& chain_;
  const PrimitiveKey& key_;
  GapSegment gap_;
  Rng& rng_;
  Vec2 target_ = Vec2::Zero();  ///< point of the gap on the first link through it
  double entry_length_ = 0;     ///< length of that link before the target
  std::vector<Vec2> points_;
  std::vector<double> directions_;
};

}  // namespace

int first_crossing_link(const PlanarChain& chain, const PrimitiveKey& key,
                        std::span<const double> q) {
  std::vector<Vec2> points;
  chain.points(q, points);
  const GapSegment gap = gap_segment(key);
  for (int link = 0; link < chain.link_count(); ++link) {
    const auto i = static_cast<std::size_t>(link);
    if (do_segments_cross(points[i], points[i + 1], gap.a, gap.b)) return link;
  }
  return -1;
}

std::optional<Configuration> sample_threaded(const CollisionChecker& checker,
                                             const PlanarChain& chain, const PrimitiveKey& key,
                                             int first_link, int attempts, Rng& rng) {
  ThreadedBuilder builder(chain, key, rng);
  for (int i = 0; i < attempts; ++i) {
    const auto directions = builder.build(first_link);
    if (!directions) continue;
    Configuration q = chain.joint_values(*directions);
    if (checker.is_valid(std::span<const double>(q))) return q;
  }
  return std::nullopt;
}

std::vector<Configuration> sample_outside(const CollisionChecker& checker, const PlanarChain& chain,
                                          const PrimitiveKey& key, int count, int attempts,
                                          Rng& rng) {
  std::vector<Configuration> found;
  for (int i = 0; i < attempts && std::ssize(found) < count; ++i) {
    Configuration q = random_configuration(checker.robot(), rng);
    const bool is_out = first_crossing_link(chain, key, q) < 0;
    if (is_out && checker.is_valid(std::span<const double>(q))) found.push_back(std::move(q));
  }
  return found;
}

}  // namespace internal
}  // namespace mneme
