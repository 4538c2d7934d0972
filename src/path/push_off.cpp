// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "path/push_off.h"

#include "base/as_index.h"
#include "base/threads.h"
#include "path/waypoints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace mneme::internal {
namespace {

/// Radians between states of a band: at first, and at most.
constexpr float kSpacing = 0.1f, kMostSpacing = 2 * kSpacing;
/// Radians that a state may move in one round: links that joints hardly move would ask for more.
constexpr float kMostPush = 0.05f;
/// Share of the distance to the midpoint of its neighbours that a state moves in one round.
constexpr float kSmoothing = 0.5f;
constexpr int kPushRounds = 6, kWideRounds = 16;
/// Metres to obstacles.
constexpr double kPushedClearance = 0.01, kWideClearance = 0.035;
/// Scale of clearances, metres, to obstacles and between links. A state may move if its motions
/// keep their place on this scale; smoothing alone would lead links into contact.
constexpr std::array<double, 3> kKept = {5e-3, 1e-3, 2e-4};
/// A state may be dropped if it is within `radians` of the segment between its kept neighbours and
/// the segment keeps `clearance`, metres, to obstacles. Few motions are cheap to verify: each costs
/// a vector of states, however short it is.
struct Beside {
  float radians;
  double clearance;
};
constexpr std::array<Beside, 5> kBeside = {
    {{0.04f, 0.025}, {0.02f, 0.01}, {0.01f, kKept[0]}, {0.01f, kKept[1]}, {0.01f, kKept[2]}}};
/// Length that clearance may cost, as a share of the path's length.
constexpr float kMostLengthening = 1.15f;

/// An elastic band: states close together that obstacles push away and neighbours pull straight.
/// Its ends stay. Quinlan and Khatib, DOI 10.1109/ROBOT.1993.291936.
class Band {
 public:
  Band(const CollisionChecker& checker, const Path& path, double clearance, CheckCounters& counters)
      : checker_(checker), waypoints_(checker.robot()), clearance_(clearance), counters_(counters) {
    waypoints_.assign(to_rows(path));
    joints_ = as_index(waypoints_.joint_count());
    rows_.assign(waypoints_[0], waypoints_[0] + joints_);
    for (int i = 0; i + 1 < waypoints_.count(); ++i) divide(waypoints_[i], waypoints_[i + 1]);
    count_ = static_cast<int>(rows_.size() / joints_);
  }

  /// Moves all states.
  void push(bool smooths) { rows_ = pushed(smooths); }
  [[nodiscard]] bool has_free_states() {
    std::vector<std::uint8_t> is_free(as_index(count_ - 2), 1);
    checker_.check_states({rows_.data() + joints_, is_free.size() * joints_}, is_free, counters_);
    return std::ranges::find(is_free, 0) == is_free.end();
  }
  /// Moves the states whose motions keep their clearance. Returns false, and moves none, if the
  /// band would be longer than `most`.
  bool push_freely(bool smooths, float most) {
    const std::vector<float> all_before = rows_, wanted = pushed(smooths);
    if (kept_.empty()) {
      for (int i = 1; i + 1 < count_; ++i) kept_.push_back(find_kept(i, std::ssize(kKept)));
    }
    for (int i = 1; i + 1 < count_; ++i) {
      const float* q = wanted.data() + as_index(i) * joints_;
      const float apart =
          std::max(waypoints_.distance(row(i - 1), q), waypoints_.distance(q, row(i + 1)));
      if (apart > kMostSpacing) continue;
      const std::vector<float> before(row(i), row(i) + joints_);
      std::copy_n(q, joints_, row(i));
      std::ptrdiff_t& kept = kept_[as_index(i - 1)];
      const std::ptrdiff_t now = find_kept(i, kept + 1);
      if (now > kept || now == std::ssize(kKept)) {
        std::ranges::copy(before, row(i));
      } else {
        kept = now;
      }
    }
    if (length() <= most) return true;
    rows_ = all_before;
    return false;
  }
  [[nodiscard]] float length() const {
    float length = 0;
    for (int i = 1; i < count_; ++i) length += waypoints_.distance(row(i - 1), row(i));
    return length;
  }

  /// The path without states that can be dropped.
  [[nodiscard]] Path thinned() {
    std::vector<int> kept = {0};
    thin(0, count_ - 1, kept);
    Path path;
    for (const int i : kept) {
      path.push_back(checker_.robot().normalized(Configuration(row(i), row(i) + joints_)));
    }
    return path;
  }

 private:
  [[nodiscard]] float* row(int i) { return rows_.data() + as_index(i) * joints_; }
  [[nodiscard]] const float* row(int i) const { return rows_.data() + as_index(i) * joints_; }

  void divide(const float* from, const float* to) {
    const int parts =
        std::max(1, static_cast<int>(std::ceil(waypoints_.distance(from, to) / kSpacing)));
    for (int i = 1; i <= parts; ++i) {
      const float share = static_cast<float>(i) / static_cast<float>(parts);
      for (std::size_t j = 0; j < joints_; ++j) {
        rows_.push_back(from[j] + share * (to[j] - from[j]));
      }
    }
  }

  [[nodiscard]] std::vector<float> pushed(bool smooths) {
    std::vector<float> rows = rows_;
    for (std::size_t i = joints_; smooths && i + joints_ < rows.size(); ++i) {
      const float middle = 0.5f * (rows_[i - joints_] + rows_[i + joints_]);
      rows[i] += kSmoothing * (middle - rows_[i]);
    }
    const std::size_t inner = as_index(count_ - 2);
    const std::vector<float> still(joints_), jitter(3 * inner);
    std::vector<float> pushed(inner * joints_), delta(joints_);
    WalkStep step;
    step.pulled_points = 0;
    step.clearance = static_cast<float>(clearance_);
    step.drift = still;
    step.jitter = jitter;
    if (inner > 0) checker_.walk({rows.data() + joints_, inner * joints_}, step, pushed, counters_);
    counters_.states += inner;
    for (std::size_t i = 0; i < inner; ++i) {
      float* q = rows.data() + (i + 1) * joints_;
      const float length =
          waypoints_.space().difference(q, pushed.data() + i * joints_, delta.data());
      const float share = length > kMostPush ? kMostPush / length : 1;
      for (std::size_t j = 0; j < joints_; ++j) q[j] += share * delta[j];
    }
    return rows;
  }

  /// Index of the first of the `tried` largest clearances that the motions of state `i` keep;
  /// `tried`, or the size of kKept if that is less, if there is none.
  std::ptrdiff_t find_kept(int i, std::ptrdiff_t tried) {
    const std::ptrdiff_t most = std::min(tried, std::ssize(kKept));
    for (std::ptrdiff_t k = 0; k < most; ++k) {
      const SweepDetail detail{kKept[static_cast<std::size_t>(k)]};
      if (sweeps_free(row(i - 1), row(i), detail) && sweeps_free(row(i), row(i + 1), detail)) {
        return k;
      }
    }
    return most;
  }
  bool sweeps_free(const float* from, const float* to, const SweepDetail& detail) {
    return checker_.is_sweep_valid({from, joints_}, {to, joints_}, counters_, detail);
  }

  /// Appends the states to keep after `first`, up to `last`.
  void thin(int first, int last, std::vector<int>& kept) {
    int farthest = (first + last) / 2;
    float beside = 0;
    for (int i = first + 1; i < last; ++i) {
      const float off = distance_to_chord(i, first, last);
      if (off > beside) beside = off, farthest = i;
    }
    if (last - first > 1 && !is_chord_good(first, last, beside)) {
      thin(first, farthest, kept);
      return thin(farthest, last, kept);
    }
    kept.push_back(last);
  }
  bool is_chord_good(int first, int last, float beside) {
    if (!waypoints_.has_unique_direction(row(first), row(last))) return false;
    return std::ranges::any_of(kBeside, [&](const Beside& most) {
      const SweepDetail detail{std::min(most.clearance, kKept[0])};
      return beside <= most.radians &&
             checker_.is_motion_valid({row(first), joints_}, {row(last), joints_}, counters_,
                                      {1, most.clearance}) &&
             sweeps_free(row(first), row(last), detail);
    });
  }
  [[nodiscard]] float distance_to_chord(int i, int first, int last) const {
    const float *a = row(first), *b = row(last), *q = row(i);
    float along = 0, length2 = 0;
    for (std::size_t j = 0; j < joints_; ++j) {
      along += (q[j] - a[j]) * (b[j] - a[j]);
      length2 += (b[j] - a[j]) * (b[j] - a[j]);
    }
    const float share = length2 > 0 ? std::clamp(along / length2, 0.0f, 1.0f) : 0;
    float off2 = 0;
    for (std::size_t j = 0; j < joints_; ++j) {
      const float off = a[j] + share * (b[j] - a[j]) - q[j];
      off2 += off * off;
    }
    return std::sqrt(off2);
  }

  const CollisionChecker& checker_;
  Waypoints waypoints_;
  double clearance_;
  CheckCounters& counters_;
  std::size_t joints_ = 0;
  std::vector<float> rows_;
  std::vector<std::ptrdiff_t> kept_;  ///< per inner state an index into kKept
  int count_ = 0;
};

}  // namespace

Path push_off(const CollisionChecker& checker, const Path& path, CheckCounters& counters) {
  if (path.size() < 2 || checker.limbs().empty()) return {};
  Band band(checker, path, kPushedClearance, counters);
  for (int round = 0; round < kPushRounds; ++round) {
    band.push(round > 0);
    if (!band.has_free_states()) continue;
    Path pushed = band.thinned();
    pushed.front() = path.front();
    pushed.back() = path.back();
    return pushed;
  }
  return {};
}

Path widen(const CollisionChecker& checker, const Path& path, const FinishSettings& settings) {
  if (path.size() < 2 || checker.limbs().empty()) return path;
  CheckCounters counters;
  Band band(checker, path, kWideClearance, counters);
  const float most = kMostLengthening * band.length();
  for (int round = 0; round < kWideRounds && band.push_freely(round > 0, most); ++round) {
    if (is_set(settings.cancel)) return path;
  }
  Path widened = band.thinned();
  widened.front() = path.front();
  widened.back() = path.back();
  FinishSettings verification = settings;
  verification.simplify = false;
  verification.verification = Verification::motions;
  PathFinisher verify(checker, verification);
  return verify(widened, counters) < 0 ? widened : path;
}

}  // namespace mneme::internal
