// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/path.h"

#include "base/as_index.h"
#include "path/waypoints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace mneme {
namespace {

using internal::as_index;
using internal::PathPoint;

/// States checked together, independent of the vector width, so that results are.
constexpr int kBatch = 16;
/// Distances that new motions keep, so that verification passes them: the first one that the nearer
/// end of the path keeps.
constexpr std::array<double, 3> kMargins = {1e-3, 2.5e-4, 0};  ///< metres
/// A waypoint is relaxed by kSteps steps, each half as long as the last, of kSubsets joint subsets.
constexpr int kSteps = 4, kSubsets = kBatch / kSteps;
/// Waypoints to relax per two batches of stretches.
constexpr int kRelaxed = 3;
/// Share of the least gain that a single waypoint must reach.
constexpr float kLeastRelaxed = 0.1f;

/// Part of a path over which a subset of joints is straightened. Arc lengths are from the start.
struct Stretch {
  PathPoint begin, end;
  float begin_arc = 0, end_arc = 0;
  std::uint64_t joints = 0;  ///< a bit each
};

class Shortener {
 public:
  Shortener(const CollisionChecker& checker, Path& path, std::uint64_t seed,
            const MotionVerifier* verifier, CheckCounters& counters,
            const std::function<bool()>& must_stop)
      : checker_(checker),
        path_(path),
        waypoints_(checker.robot()),
        joints_(waypoints_.joint_count()),
        all_joints_(joints_ < 64 ? (std::uint64_t{1} << joints_) - 1 : ~std::uint64_t{0}),
        rng_(seed),
        verifier_(verifier),
        counters_(counters),
        must_stop_(must_stop),
        states_(as_index(kBatch * joints_)) {
    waypoints_.assign(internal::to_rows(path));
    start_margin_ = margin_at(0);
    goal_margin_ = margin_at(waypoints_.count() - 1);
  }

  /// From each waypoint on, straight to the farthest one that can be reached.
  void prune() {
    for (int i = 0; i + 2 < waypoints_.count() && !is_stopped(); ++i)
      waypoints_.replace(i, find_farthest(i), {});
    waypoints_.assign({waypoints_[0], waypoints_[0] + waypoints_.count() * joints_});
  }

  /// Relaxes waypoints and shortens stretches until the effort is spent without gain.
  void shorten(const ShortenEffort& effort) {
    least_gain_ = static_cast<float>(effort.least_gain);
    double idle = 0;
    for (int step = 0; idle < effort.patience && waypoints_.count() > 2; step = (step + 1) % 3) {
      if (is_stopped()) return;
      const std::uint64_t states = counters_.states;
      const float before = waypoints_.length();
      int tries = kRelaxed;
      if (step == 0) {
        for (int i = 0; i < kRelaxed && waypoints_.count() > 2; ++i) relax();
      } else {
        tries = shorten_stretch(step == 2);
      }
      // Tries without a state check also cost time.
      const auto cost = static_cast<double>(counters_.states - states + as_index(tries));
      const bool is_gain = before - waypoints_.length() >= least_gain_ * before;
      idle = is_gain ? 0 : idle + cost / kBatch;
    }
  }

  void store();

 private:
  [[nodiscard]] bool is_stopped() const { return must_stop_ && must_stop_(); }
  [[nodiscard]] float* state(int i) { return states_.data() + i * joints_; }

  /// The largest margin that an end of the path has.
  double margin_at(int i) {
    const std::span<const float> q = waypoints_.rows(i, i + 1);
    const auto found = std::ranges::find_if(kMargins, [&](double margin) {
      return checker_.is_motion_valid(q, q, counters_, {1, margin});
    });
    return found == kMargins.end() ? 0.0 : *found;
  }
  /// Between two waypoints.
  [[nodiscard]] double margin(int first, int last) const {
    return std::min(first == 0 ? start_margin_ : kMargins[0],
                    last == waypoints_.count() - 1 ? goal_margin_ : kMargins[0]);
  }

  /// Which of the first `count` states are free.
  void check_middles(int count) {
    const auto size = as_index(count);
    counters_.states += kBatch;
    checker_.check_states({states_.data(), as_index(count * joints_)}, {is_free_.data(), size});
  }

  /// True if the motions along `rows`, which replace those between two waypoints, are free.
  bool is_free(std::span<const float> rows, int first, int last) {
    const auto count = static_cast<int>(rows.size()) / joints_;
    for (int i = 0; i + 1 < count; ++i) {
      if (!waypoints_.has_unique_direction(&rows[as_index(i * joints_)],
                                           &rows[as_index((i + 1) * joints_)]))
        return false;
    }
    return is_chain_free(rows, first, last);
  }

  bool is_chain_free(std::span<const float> rows, int first, int last) {
    if (!checker_.is_chain_valid(rows, counters_, {1, margin(first, last)})) return false;
    const auto joints = as_index(joints_);
    for (std::size_t i = 0; verifier_ != nullptr && i + joints < rows.size(); i += joints) {
      const MotionEnds ends{first == 0 && i == 0,
                            last == waypoints_.count() - 1 && i + 2 * joints == rows.size()};
      if (!verifier_->is_free(rows.subspan(i, joints), rows.subspan(i + joints, joints), ends,
                              counters_)) {
        return false;
      }
    }
    return true;
  }

  int find_farthest(int first);
  void relax();
  void write_relaxed(int k);
  bool take_relaxed(int k, int candidate);
  std::uint64_t random_joints();
  int shorten_stretch(bool has_all_joints);
  bool sample_stretch(Stretch& stretch, bool has_all_joints);
  [[nodiscard]] float length_of(const Stretch& stretch);
  void write_state(const Stretch& stretch, float arc_length, float* q) const;
  void write_rows(const Stretch& stretch);
  bool take(const Stretch& stretch);

  const CollisionChecker& checker_;
  Path& path_;
  internal::Waypoints waypoints_;
  int joints_;
  std::uint64_t all_joints_;
  Rng rng_;
  const MotionVerifier* verifier_;
  CheckCounters& counters_;
  const std::function<bool()>& must_stop_;
  std::vector<float> states_;
  std::array<std::uint8_t, kBatch> is_free_ = {};
  std::vector<float> rows_, ends_;
  double start_margin_ = 0, goal_margin_ = 0;
  float least_gain_ = 0;
  int relaxed_ = 0;  ///< the waypoint that was relaxed last
};

int Shortener::find_farthest(int first) {
  const internal::JointSpace& space = waypoints_.space();
  std::vector<float> delta(as_index(joints_));
  const float* from = waypoints_[first];
  for (int last = waypoints_.count() - 1; last > first + 1;) {
    const int count = std::min(kBatch, last - first - 1);
    for (int i = 0; i < count; ++i) {
      space.difference(from, waypoints_[last - i], delta.data());
      for (int j = 0; j < joints_; ++j) state(i)[j] = from[j] + 0.5f * delta[as_index(j)];
    }
    check_middles(count);
    for (int i = 0; i < count; ++i, --last) {
      if (is_free_[as_index(i)] == 0) continue;
      rows_.assign(from, from + joints_);
      space.difference(from, waypoints_[last], delta.data());
      for (int j = 0; j < joints_; ++j) rows_.push_back(from[j] + delta[as_index(j)]);
      if (is_free(rows_, first, last)) return last;
    }
  }
  return first + 1;
}

std::uint64_t Shortener::random_joints() {
  while (true) {
    const std::uint64_t joints = rng_.next() & all_joints_;
    if (joints != 0) return joints;
  }
}

/// Pulls a waypoint towards the segment between its neighbours.
void Shortener::relax() {
  relaxed_ = 1 + relaxed_ % (waypoints_.count() - 2);
  const int k = relaxed_;
  const float before = waypoints_.arc_length(k + 1) - waypoints_.arc_length(k - 1);
  const float least = kLeastRelaxed * least_gain_ * waypoints_.length();
  if (before - waypoints_.distance(waypoints_[k - 1], waypoints_[k + 1]) < least) return;
  write_relaxed(k);
  check_middles(kBatch);
  std::array<float, kBatch> gains = {};
  for (int i = 0; i < kBatch; ++i) {
    if (is_free_[as_index(i)] == 0) continue;
    gains[as_index(i)] = before - waypoints_.distance(waypoints_[k - 1], state(i)) -
                         waypoints_.distance(state(i), waypoints_[k + 1]);
  }
  for (int tries = 0; tries < 2; ++tries) {
    const auto best = std::ranges::max_element(gains);
    if (*best <= least || take_relaxed(k, static_cast<int>(best - gains.begin()))) return;
    *best = 0;
  }
}

/// The first candidate is on the segment.
void Shortener::write_relaxed(int k) {
  const float *a = waypoints_[k - 1], *q = waypoints_[k], *b = waypoints_[k + 1];
  const float fraction = (waypoints_.arc_length(k) - waypoints_.arc_length(k - 1)) /
                         (waypoints_.arc_length(k + 1) - waypoints_.arc_length(k - 1));
  for (int i = 0; i < kBatch; i += kSteps) {
    const std::uint64_t joints = i == 0 ? all_joints_ : random_joints();
    for (int j = 0; j < joints_; ++j) {
      float step = (joints >> j & 1) != 0 ? a[j] + fraction * (b[j] - a[j]) - q[j] : 0;
      for (int s = 0; s < kSteps; ++s, step *= 0.5f) state(i + s)[j] = q[j] + step;
    }
  }
}

bool Shortener::take_relaxed(int k, int candidate) {
  const bool is_dropped = candidate == 0;
  rows_.assign(waypoints_[k - 1], waypoints_[k]);
  if (!is_dropped) rows_.insert(rows_.end(), state(candidate), state(candidate) + joints_);
  rows_.insert(rows_.end(), waypoints_[k + 1], waypoints_[k + 1] + joints_);
  if (!is_free(rows_, k - 1, k + 1)) return false;
  waypoints_.replace(k - 1, k + 1, {rows_.data() + joints_, as_index(is_dropped ? 0 : joints_)});
  return true;
}

void Shortener::write_state(const Stretch& stretch, float arc_length, float* q) const {
  waypoints_.write(waypoints_.locate(arc_length), q);
  const float fraction = (arc_length - stretch.begin_arc) / (stretch.end_arc - stretch.begin_arc);
  const float *from = ends_.data(), *to = ends_.data() + joints_;
  for (int j = 0; j < joints_; ++j) {
    if ((stretch.joints >> j & 1) != 0) q[j] = from[j] + fraction * (to[j] - from[j]);
  }
}

/// Writes the straightened stretch, with its ends, into rows_.
void Shortener::write_rows(const Stretch& stretch) {
  ends_.resize(as_index(2 * joints_));
  waypoints_.write(stretch.begin, ends_.data());
  waypoints_.write(stretch.end, ends_.data() + joints_);
  rows_.assign(ends_.begin(), ends_.begin() + joints_);
  if (stretch.joints != all_joints_) {
    const float length = stretch.end_arc - stretch.begin_arc;
    for (int i = stretch.begin.motion + 1; i <= stretch.end.motion; ++i) {
      const float fraction = (waypoints_.arc_length(i) - stretch.begin_arc) / length;
      const float* q = waypoints_[i];
      for (int j = 0; j < joints_; ++j) {
        const float from = ends_[as_index(j)], to = ends_[as_index(joints_ + j)];
        rows_.push_back((stretch.joints >> j & 1) != 0 ? from + fraction * (to - from) : q[j]);
      }
    }
  }
  rows_.insert(rows_.end(), ends_.begin() + joints_, ends_.end());
}

float Shortener::length_of(const Stretch& stretch) {
  write_rows(stretch);
  float length = 0;
  for (std::size_t i = as_index(joints_); i < rows_.size(); i += as_index(joints_)) {
    length += waypoints_.distance(&rows_[i - as_index(joints_)], &rows_[i]);
  }
  return length;
}

bool Shortener::sample_stretch(Stretch& stretch, bool has_all_joints) {
  const float length = waypoints_.length();
  float first = static_cast<float>(rng_.uniform()) * length;
  float second = static_cast<float>(rng_.uniform()) * length;
  if (first > second) std::swap(first, second);
  stretch = {waypoints_.locate(first), waypoints_.locate(second), first, second,
             has_all_joints ? all_joints_ : random_joints()};
  if (stretch.begin.motion == stretch.end.motion) return false;
  return second - first - length_of(stretch) >= least_gain_ * length;
}

/// Tries up to a batch of stretches and returns their number. A stretch whose midpoint is in
/// contact costs one lane only.
int Shortener::shorten_stretch(bool has_all_joints) {
  std::array<Stretch, kBatch> stretches;
  int count = 0;
  for (int tries = 0; tries < kBatch; ++tries) {
    Stretch& stretch = stretches[as_index(count)];
    if (!sample_stretch(stretch, has_all_joints)) continue;
    write_state(stretch, 0.5f * (stretch.begin_arc + stretch.end_arc), state(count));
    ++count;
  }
  if (count == 0) return kBatch;
  check_middles(count);
  for (int i = 0; i < count; ++i) {
    if (is_free_[as_index(i)] == 0) continue;
    if (is_stopped() || take(stretches[as_index(i)])) break;
  }
  return kBatch;
}

bool Shortener::take(const Stretch& stretch) {
  write_rows(stretch);
  const int first = stretch.begin.motion, last = stretch.end.motion + 1;
  if (!is_free(rows_, first, last)) return false;
  // The stretch begins between checked states of its old motion.
  const std::span<const float> begin(rows_.data(), as_index(joints_));
  if (!checker_.is_motion_valid(begin, begin, counters_)) return false;
  waypoints_.replace(first, last, rows_);
  return true;
}

void Shortener::store() {
  std::vector<std::vector<float>> nodes;
  for (int i = 0; i < waypoints_.count(); ++i)
    nodes.emplace_back(waypoints_[i], waypoints_[i] + joints_);
  Path result = internal::to_path(checker_.robot(), nodes);
  result.front() = path_.front();
  result.back() = path_.back();
  path_ = std::move(result);
}

}  // namespace

double path_length(const Robot& robot, const Path& path) {
  double length = 0;
  for (std::size_t i = 1; i < path.size(); ++i) length += robot.distance(path[i - 1], path[i]);
  return length;
}

void shorten(const CollisionChecker& checker, Path& path, std::uint64_t seed,
             const ShortenEffort& effort, const MotionVerifier* verifier, CheckCounters& counters,
             const std::function<bool()>& must_stop) {
  if (path.size() < 3) return;
  Shortener shortener(checker, path, seed, verifier, counters, must_stop);
  shortener.prune();
  shortener.shorten(effort);
  shortener.store();
}

}  // namespace mneme
