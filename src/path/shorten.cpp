// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/path.h"

#include "base/as_index.h"
#include "path/waypoints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

namespace mneme {
namespace {

using internal::as_index;

/// States checked together. Independent of the vector width, so that results are, too.
constexpr int kBatch = kShortcuts;
/// Margin of motions next to an end of the path that does not keep the effort's margin but keeps
/// this one.
constexpr double kEndMargin = 2.5e-4;  ///< metres
/// Waypoints to relax per two batches of stretches.
constexpr int kRelaxed = 3;
/// Share of the least gain that a single waypoint must reach.
constexpr float kLeastRelaxed = 0.1f;

class Shortener {
 public:
  Shortener(const CollisionChecker& checker, Path& path, std::uint64_t seed,
            const ShortenEffort& effort, const MotionVerifier* verifier, CheckCounters& counters,
            const std::function<bool()>& must_stop)
      : checker_(checker),
        path_(path),
        waypoints_(checker.robot(), effort.minimize_time
                                        ? internal::paces_of(checker.robot(), path, effort.limits)
                                        : std::vector<float>()),
        joints_(waypoints_.joint_count()),
        all_joints_(joints_ < 64 ? (std::uint64_t{1} << joints_) - 1 : ~std::uint64_t{0}),
        rng_(seed),
        effort_(effort),
        verifier_(verifier),
        counters_(counters),
        must_stop_(must_stop),
        states_(as_index(kBatch * joints_)),
        least_gain_(static_cast<float>(effort.least_gain)) {
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
  void shorten() {
    double idle = 0;
    for (int step = 0; idle < effort_.patience && waypoints_.count() > 2; step = (step + 1) % 3) {
      if (is_stopped()) return;
      const std::uint64_t states = counters_.states;
      const float before = waypoints_.length();
      int tries = kRelaxed;
      if (step == 0) {
        for (int i = 0; i < kRelaxed && waypoints_.count() > 2; ++i) relax();
      } else {
        tries = take_shortcut(step == 2);
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

  /// The margin of motions next to an end of the path.
  double margin_at(int i) {
    const std::span<const float> q = waypoints_.rows(i, i + 1);
    for (const double margin : {effort_.margin, kEndMargin}) {
      if (checker_.is_motion_valid(q, q, counters_, {1, margin})) return margin;
    }
    return 0;
  }
  /// Between two waypoints.
  [[nodiscard]] double margin(int first, int last) const {
    return std::min(first == 0 ? start_margin_ : effort_.margin,
                    last == waypoints_.count() - 1 ? goal_margin_ : effort_.margin);
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
    if (!checker_.is_chain_valid(rows, counters_, {effort_.refinement, margin(first, last)}))
      return false;
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
  bool take_relaxed(const Relaxation& relaxation, int candidate);
  std::uint64_t random_joints();
  std::array<Shortcut, kShortcuts> sample_shortcuts(bool has_all_joints);
  int take_shortcut(bool has_all_joints);
  void write_rows(const Shortcut& shortcut, PathPoint begin, PathPoint end);
  bool take(const Shortcut& shortcut);

  const CollisionChecker& checker_;
  Path& path_;
  internal::Waypoints waypoints_;
  int joints_;
  std::uint64_t all_joints_;
  Rng rng_;
  const ShortenEffort& effort_;
  const MotionVerifier* verifier_;
  CheckCounters& counters_;
  const std::function<bool()>& must_stop_;
  std::vector<float> states_;
  float least_gain_;
  std::array<std::uint8_t, kBatch> is_free_ = {};
  std::vector<float> rows_, ends_;
  double start_margin_ = 0, goal_margin_ = 0;
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
  const Relaxation relaxation{k, {all_joints_, random_joints(), random_joints(), random_joints()}};
  std::array<float, kShortcuts> gains;
  counters_.states += kBatch;
  checker_.rate_relaxations(waypoints_.view(), relaxation, gains);
  const auto best = std::ranges::max_element(gains);
  if (*best > least) take_relaxed(relaxation, static_cast<int>(best - gains.begin()));
}

bool Shortener::take_relaxed(const Relaxation& relaxation, int candidate) {
  const int k = relaxation.waypoint;
  const float *a = waypoints_[k - 1], *q = waypoints_[k], *b = waypoints_[k + 1];
  const float fraction = (waypoints_.arc_length(k) - waypoints_.arc_length(k - 1)) /
                         (waypoints_.arc_length(k + 1) - waypoints_.arc_length(k - 1));
  const std::uint64_t joints = relaxation.subset(candidate);
  const float step = relaxation.step(candidate);
  const bool is_dropped = joints == all_joints_ && step == 1;  // it would be on the segment
  rows_.assign(a, q);
  for (int j = 0; j < joints_ && !is_dropped; ++j) {
    const float whole = a[j] + fraction * (b[j] - a[j]) - q[j];
    rows_.push_back((joints >> j & 1) != 0 ? q[j] + step * whole : q[j]);
  }
  rows_.insert(rows_.end(), b, b + joints_);
  if (!is_free(rows_, k - 1, k + 1)) return false;
  waypoints_.replace(k - 1, k + 1, {rows_.data() + joints_, as_index(is_dropped ? 0 : joints_)});
  return true;
}

/// Writes the straightened stretch, with its ends, into rows_.
void Shortener::write_rows(const Shortcut& shortcut, PathPoint begin, PathPoint end) {
  ends_.resize(as_index(2 * joints_));
  float *from = ends_.data(), *to = from + joints_;
  waypoints_.write(begin, from);
  waypoints_.write(end, to);
  rows_.assign(from, to);
  const float length = shortcut.end - shortcut.begin;
  for (int i = begin.motion + 1; i <= end.motion && shortcut.joints != all_joints_; ++i) {
    const float fraction = (waypoints_.arc_length(i) - shortcut.begin) / length;
    const float* q = waypoints_[i];
    for (int j = 0; j < joints_; ++j) {
      const bool is_straight = (shortcut.joints >> j & 1) != 0;
      rows_.push_back(is_straight ? from[j] + fraction * (to[j] - from[j]) : q[j]);
    }
  }
  rows_.insert(rows_.end(), to, to + joints_);
}

std::array<Shortcut, kShortcuts> Shortener::sample_shortcuts(bool has_all_joints) {
  const float length = waypoints_.length();
  std::array<Shortcut, kShortcuts> shortcuts;
  for (Shortcut& shortcut : shortcuts) {
    const auto first = static_cast<float>(rng_.uniform()) * length;
    const auto second = static_cast<float>(rng_.uniform()) * length;
    shortcut.begin = std::min(first, second);
    shortcut.end = std::max(first, second);
    shortcut.joints = has_all_joints ? all_joints_ : random_joints();
  }
  return shortcuts;
}

/// Takes the first free shortcut of a batch, largest gain first, and returns the batch's size. A
/// shortcut whose midpoint is in contact costs one lane only.
int Shortener::take_shortcut(bool has_all_joints) {
  std::array<Shortcut, kShortcuts> shortcuts = sample_shortcuts(has_all_joints);
  const float least = least_gain_ * waypoints_.length();
  checker_.rate_shortcuts(waypoints_.view(), least, shortcuts);
  std::ranges::sort(shortcuts, std::greater(), &Shortcut::gain);
  if (shortcuts.front().gain < least) return kBatch;
  counters_.states += kBatch;
  for (const Shortcut& shortcut : shortcuts) {
    if (shortcut.is_promising && (is_stopped() || take(shortcut))) break;
  }
  return kBatch;
}

bool Shortener::take(const Shortcut& shortcut) {
  const PathPoint begin = waypoints_.locate(shortcut.begin), end = waypoints_.locate(shortcut.end);
  if (begin.motion == end.motion) return false;
  write_rows(shortcut, begin, end);
  if (!is_free(rows_, begin.motion, end.motion + 1)) return false;
  // The stretch begins between checked states of its old motion.
  const std::span<const float> first(rows_.data(), as_index(joints_));
  if (effort_.refinement >= 1 && !checker_.is_motion_valid(first, first, counters_)) return false;
  waypoints_.replace(begin.motion, end.motion + 1, rows_);
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

double path_time(const Robot& robot, const Path& path, const RateLimits* limits) {
  if (path.empty()) return 0;
  internal::Waypoints waypoints(robot, internal::paces_of(robot, path, limits));
  waypoints.assign(internal::to_rows(path));
  return waypoints.length();
}

void shorten(const CollisionChecker& checker, Path& path, std::uint64_t seed,
             const ShortenEffort& effort, const MotionVerifier* verifier, CheckCounters& counters,
             const std::function<bool()>& must_stop) {
  if (path.size() < 3) return;
  Shortener shortener(checker, path, seed, effort, verifier, counters, must_stop);
  shortener.prune();
  shortener.shorten();
  shortener.store();
}

}  // namespace mneme
