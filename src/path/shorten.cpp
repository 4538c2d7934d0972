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

/// States that are looked at together, whatever the machine's vectors.
constexpr int kBatch = 16;
/// A shorter path hugs obstacles: it keeps this far away, so that verification passes it, or the
/// next one if its own end does not.
constexpr std::array<double, 3> kMargins = {1e-3, 2.5e-4, 0};  ///< metres
/// A waypoint is relaxed by four steps, each half as long as the one before, of four subsets of
/// joints.
constexpr int kSteps = 4, kSubsets = kBatch / kSteps;
/// So many waypoints are relaxed for each two batches of stretches.
constexpr int kRelaxed = 3;
/// Several waypoints may gain together what one need not.
constexpr float kLeastRelaxed = 0.1f;

/// Part of a path whose joints of a subset are to go straight from one end to the other.
struct Stretch {
  PathPoint begin, end;
  float begin_way = 0, end_way = 0;
  std::uint64_t joints = 0;  ///< a bit each
};

class Shortener {
 public:
  Shortener(const CollisionChecker& checker, Path& path, std::uint64_t seed,
            const MotionVerifier* verifier, CheckCounters& counters,
            const std::function<bool()>& must_stop)
      : checker_(checker),
        path_(path),
        way_(checker.robot()),
        joints_(way_.joint_count()),
        all_joints_(joints_ < 64 ? (std::uint64_t{1} << joints_) - 1 : ~std::uint64_t{0}),
        rng_(seed),
        verifier_(verifier),
        counters_(counters),
        must_stop_(must_stop),
        states_(as_index(kBatch * joints_)) {
    way_.assign(internal::to_rows(path));
    start_margin_ = margin_at(0);
    goal_margin_ = margin_at(way_.count() - 1);
  }

  /// From each waypoint on, straight to the farthest one that can be reached.
  void prune() {
    for (int i = 0; i + 2 < way_.count() && !is_stopped(); ++i)
      way_.replace(i, find_farthest(i), {});
    way_.assign({way_[0], way_[0] + way_.count() * joints_});
  }

  /// Relaxes waypoints and shortens stretches until that much was looked at in vain.
  void shorten(const ShortenEffort& effort) {
    least_gain_ = static_cast<float>(effort.least_gain);
    double idle = 0;
    for (int step = 0; idle < effort.patience && way_.count() > 2; step = (step + 1) % 3) {
      if (is_stopped()) return;
      const std::uint64_t states = counters_.states;
      const float before = way_.length();
      int tries = kRelaxed;
      if (step == 0) {
        for (int i = 0; i < kRelaxed && way_.count() > 2; ++i) relax();
      } else {
        tries = shorten_stretch(step == 2);
      }
      // A try that looks at nothing is not free either.
      const auto cost = static_cast<double>(counters_.states - states + as_index(tries));
      const bool is_gain = before - way_.length() >= least_gain_ * before;
      idle = is_gain ? 0 : idle + cost / kBatch;
    }
  }

  void store();

 private:
  [[nodiscard]] bool is_stopped() const { return must_stop_ && must_stop_(); }
  [[nodiscard]] float* state(int i) { return states_.data() + i * joints_; }

  /// The largest margin that an end of the path has.
  double margin_at(int i) {
    const std::span<const float> q = way_.rows(i, i + 1);
    const auto found = std::ranges::find_if(kMargins, [&](double margin) {
      return checker_.is_motion_valid(q, q, counters_, {1, margin});
    });
    return found == kMargins.end() ? 0.0 : *found;
  }
  /// Between two waypoints.
  [[nodiscard]] double margin(int first, int last) const {
    return std::min(first == 0 ? start_margin_ : kMargins[0],
                    last == way_.count() - 1 ? goal_margin_ : kMargins[0]);
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
      if (!way_.has_one_way(&rows[as_index(i * joints_)], &rows[as_index((i + 1) * joints_)]))
        return false;
    }
    return is_chain_free(rows, first, last);
  }

  bool is_chain_free(std::span<const float> rows, int first, int last) {
    if (!checker_.is_chain_valid(rows, counters_, {1, margin(first, last)})) return false;
    const auto joints = as_index(joints_);
    for (std::size_t i = 0; verifier_ != nullptr && i + joints < rows.size(); i += joints) {
      const MotionEnds ends{first == 0 && i == 0,
                            last == way_.count() - 1 && i + 2 * joints == rows.size()};
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
  void write_state(const Stretch& stretch, float way, float* q) const;
  void write_rows(const Stretch& stretch);
  bool take(const Stretch& stretch);

  const CollisionChecker& checker_;
  Path& path_;
  internal::Waypoints way_;
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
  const internal::JointSpace& space = way_.space();
  std::vector<float> delta(as_index(joints_));
  const float* from = way_[first];
  for (int last = way_.count() - 1; last > first + 1;) {
    const int count = std::min(kBatch, last - first - 1);
    for (int i = 0; i < count; ++i) {
      space.difference(from, way_[last - i], delta.data());
      for (int j = 0; j < joints_; ++j) state(i)[j] = from[j] + 0.5f * delta[as_index(j)];
    }
    check_middles(count);
    for (int i = 0; i < count; ++i, --last) {
      if (is_free_[as_index(i)] == 0) continue;
      rows_.assign(from, from + joints_);
      space.difference(from, way_[last], delta.data());
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

/// Pulls a waypoint towards the straight way between its neighbours.
void Shortener::relax() {
  relaxed_ = 1 + relaxed_ % (way_.count() - 2);
  const int k = relaxed_;
  const float before = way_.way_to(k + 1) - way_.way_to(k - 1);
  const float least = kLeastRelaxed * least_gain_ * way_.length();
  if (before - way_.distance(way_[k - 1], way_[k + 1]) < least) return;
  write_relaxed(k);
  check_middles(kBatch);
  std::array<float, kBatch> gains = {};
  for (int i = 0; i < kBatch; ++i) {
    if (is_free_[as_index(i)] == 0) continue;
    gains[as_index(i)] =
        before - way_.distance(way_[k - 1], state(i)) - way_.distance(state(i), way_[k + 1]);
  }
  for (int tries = 0; tries < 2; ++tries) {
    const auto best = std::ranges::max_element(gains);
    if (*best <= least || take_relaxed(k, static_cast<int>(best - gains.begin()))) return;
    *best = 0;
  }
}

/// The first candidate is on the straight way.
void Shortener::write_relaxed(int k) {
  const float *a = way_[k - 1], *q = way_[k], *b = way_[k + 1];
  const float fraction =
      (way_.way_to(k) - way_.way_to(k - 1)) / (way_.way_to(k + 1) - way_.way_to(k - 1));
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
  rows_.assign(way_[k - 1], way_[k]);
  if (!is_dropped) rows_.insert(rows_.end(), state(candidate), state(candidate) + joints_);
  rows_.insert(rows_.end(), way_[k + 1], way_[k + 1] + joints_);
  if (!is_free(rows_, k - 1, k + 1)) return false;
  way_.replace(k - 1, k + 1, {rows_.data() + joints_, as_index(is_dropped ? 0 : joints_)});
  return true;
}

void Shortener::write_state(const Stretch& stretch, float way, float* q) const {
  way_.write(way_.locate(way), q);
  const float fraction = (way - stretch.begin_way) / (stretch.end_way - stretch.begin_way);
  const float *from = ends_.data(), *to = ends_.data() + joints_;
  for (int j = 0; j < joints_; ++j) {
    if ((stretch.joints >> j & 1) != 0) q[j] = from[j] + fraction * (to[j] - from[j]);
  }
}

/// The new way of a stretch, ends included, into rows_.
void Shortener::write_rows(const Stretch& stretch) {
  ends_.resize(as_index(2 * joints_));
  way_.write(stretch.begin, ends_.data());
  way_.write(stretch.end, ends_.data() + joints_);
  rows_.assign(ends_.begin(), ends_.begin() + joints_);
  if (stretch.joints != all_joints_) {
    const float way = stretch.end_way - stretch.begin_way;
    for (int i = stretch.begin.motion + 1; i <= stretch.end.motion; ++i) {
      const float fraction = (way_.way_to(i) - stretch.begin_way) / way;
      const float* q = way_[i];
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
    length += way_.distance(&rows_[i - as_index(joints_)], &rows_[i]);
  }
  return length;
}

bool Shortener::sample_stretch(Stretch& stretch, bool has_all_joints) {
  const float length = way_.length();
  float first = static_cast<float>(rng_.uniform()) * length;
  float second = static_cast<float>(rng_.uniform()) * length;
  if (first > second) std::swap(first, second);
  stretch = {way_.locate(first), way_.locate(second), first, second,
             has_all_joints ? all_joints_ : random_joints()};
  if (stretch.begin.motion == stretch.end.motion) return false;
  return second - first - length_of(stretch) >= least_gain_ * length;
}

/// Tries up to a batch of stretches, and returns how many; those whose middle touches something
/// cost no more than that.
int Shortener::shorten_stretch(bool has_all_joints) {
  std::array<Stretch, kBatch> stretches;
  int count = 0;
  for (int tries = 0; tries < kBatch; ++tries) {
    Stretch& stretch = stretches[as_index(count)];
    if (!sample_stretch(stretch, has_all_joints)) continue;
    write_state(stretch, 0.5f * (stretch.begin_way + stretch.end_way), state(count));
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
  // A motion that was checked may touch something between the states that were looked at.
  const std::span<const float> begin(rows_.data(), as_index(joints_));
  if (!checker_.is_motion_valid(begin, begin, counters_)) return false;
  way_.replace(first, last, rows_);
  return true;
}

void Shortener::store() {
  std::vector<std::vector<float>> nodes;
  for (int i = 0; i < way_.count(); ++i) nodes.emplace_back(way_[i], way_[i] + joints_);
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
