// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/path.h"

#include "base/as_index.h"
#include "path/waypoints.h"

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <utility>

namespace mneme {
namespace {

using internal::as_index;

/// States checked together. Independent of the vector width, so that results are, too.
constexpr int kBatch = kShortcuts;
/// Margin of motions next to an end of the path that does not keep the effort's margin but keeps
/// this one.
constexpr double kEndMargin = 2.5e-4;  ///< metres
/// Margin of pairs that are checked by exact geometry: no larger than the spare of their proven
/// cells, which larger margins would leave unused.
constexpr double kExactMargin = 2e-4;  ///< metres
/// Waypoints to relax per two batches of shortcuts.
constexpr int kRelaxed = 2;
/// Share of the least gain that a single waypoint must reach.
constexpr float kLeastRelaxed = 0.1f;
/// Share of ShortenEffort::patience for a path as short as the distance of its ends. It grows with
/// the path's excess, up to the whole patience at kGreatExcess.
constexpr double kLeastPatience = 0.3, kGreatExcess = 0.2;
/// Number of waypoints to which pruning tries the straight motion from another.
constexpr int kMostPruned = 5;

/// Where shortcuts touched last, as arc lengths of a path. Further shortcuts past these places
/// touch there more often than in their middle.
class Contacts {
 public:
  void add(float arc_length) {
    std::shift_right(places_.begin(), places_.end(), 1);
    places_.front() = arc_length;
  }
  /// Follows the path when its stretch from `begin` to `end` shrinks to `length`.
  void follow(float begin, float end, float length) {
    if (!(end > begin)) return;
    const float scale = (length - (end - begin)) / (end - begin);
    for (float& place : places_) place += scale * std::clamp(place - begin, 0.0f, end - begin);
  }
  /// The fraction of a stretch where contact is most likely.
  [[nodiscard]] float probe(float begin, float end) const {
    constexpr float kBorder = 0.1f;  // ends of stretches are free
    for (const float place : places_) {
      const float fraction = (place - begin) / (end - begin);
      if (fraction > kBorder && fraction < 1 - kBorder) return fraction;
    }
    return 0.5f;
  }

 private:
  std::array<float, 4> places_ = {-1, -1, -1, -1};
};

/// True if the subset holds joint `j`. As in the kernels, joints beyond 64 share the bits of
/// others.
bool is_among(std::uint64_t joints, int j) {
  return (joints >> (j < 32 ? j : 32 + j % 32) & 1) != 0;
}

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
      replace(i, find_farthest(i), {});
    waypoints_.assign({waypoints_[0], waypoints_[0] + waypoints_.count() * joints_});
  }

  /// Relaxes waypoints and shortens stretches until the effort is spent without gain.
  void shorten() {
    double idle = 0;
    for (int step = 0; idle < patience() && waypoints_.count() > 2; step = (step + 1) % 3) {
      if (is_stopped()) return;
      const std::uint64_t states = counters_.states;
      const float before = waypoints_.length();
      const int tries = step == 0 ? kRelaxed : kBatch;
      if (step == 0) {
        for (int i = 0; i < kRelaxed && waypoints_.count() > 2; ++i) relax();
      } else {
        take_shortcuts(step == 2);
      }
      // Tries without a state check also cost time.
      const auto cost = static_cast<double>(counters_.states - states + as_index(tries));
      const bool is_gain = before - waypoints_.length() >= least_gain_ * before;
      idle = is_gain ? 0 : idle + cost / kBatch;
    }
  }

  void store();

 private:
  /// Checks in vain that end shortening: fewer where little can be gained, as no path is shorter
  /// than the distance of its ends. Paths that are nearly straight may still take less time.
  [[nodiscard]] double patience() const {
    if (effort_.minimize_time) return effort_.patience;
    const float least = waypoints_.distance(waypoints_[0], waypoints_[waypoints_.count() - 1]);
    const double excess = 1 - least / waypoints_.length();
    const double share = kLeastPatience + (1 - kLeastPatience) * excess / kGreatExcess;
    return effort_.patience * std::min(share, 1.0);
  }
  /// Reads the clock only after so many states that it costs little.
  [[nodiscard]] bool is_stopped() {
    if (is_stopped_ || counters_.states < next_look_) return is_stopped_;
    next_look_ = counters_.states + kBatch * kBatch;
    is_stopped_ = must_stop_ && must_stop_();
    return is_stopped_;
  }
  [[nodiscard]] float* state(int i) { return states_.data() + i * joints_; }

  /// The margin of motions next to an end of the path.
  double margin_at(int i) {
    const std::span<const float> q = waypoints_.rows(i, i + 1);
    for (const double margin : {effort_.margin, kEndMargin}) {
      if (checker_.is_motion_valid(q, q, counters_, {1, margin, kExactMargin})) return margin;
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
    contact_.reset();
    const auto count = static_cast<int>(rows.size()) / joints_;
    for (int i = 0; i + 1 < count; ++i) {
      if (!waypoints_.has_unique_direction(&rows[as_index(i * joints_)],
                                           &rows[as_index((i + 1) * joints_)]))
        return false;
    }
    return is_chain_free(rows, first, last);
  }

  bool is_chain_free(std::span<const float> rows, int first, int last) {
    const MotionDetail detail{effort_.refinement, margin(first, last), kExactMargin};
    if (!checker_.is_chain_valid(rows, counters_, detail, &contact_)) return false;
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

  /// Replaces the waypoints between two.
  void replace(int first, int last, std::span<const float> rows) {
    const float begin = waypoints_.arc_length(first), end = waypoints_.arc_length(last);
    const float before = waypoints_.length();
    waypoints_.replace(first, last, rows);
    contacts_.follow(begin, end, end - begin - (before - waypoints_.length()));
  }

  int find_farthest(int first);
  void relax();
  bool take_relaxed(const Relaxation& relaxation, int candidate);
  std::uint64_t random_joints();
  std::array<Shortcut, kShortcuts> sample_shortcuts(bool has_all_joints);
  void take_shortcuts(bool has_all_joints);
  void write_rows(const Shortcut& shortcut, PathPoint begin, PathPoint end);
  static void follow(const Shortcut& taken, Shortcut& other);
  bool take(const Shortcut& shortcut);
  [[nodiscard]] float arc_length_of(PathPoint point, const Shortcut& shortcut,
                                    PathPoint begin) const;

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
  std::vector<float> rows_, delta_;
  double start_margin_ = 0, goal_margin_ = 0;
  int relaxed_ = 0;                   ///< the waypoint that was relaxed last
  std::optional<PathPoint> contact_;  ///< of the chain that was checked last
  Contacts contacts_;
  std::uint64_t next_look_ = 0;  ///< at the clock, in states
  bool is_stopped_ = false;
};

int Shortener::find_farthest(int first) {
  const internal::JointSpace& space = waypoints_.space();
  delta_.resize(as_index(joints_));
  const float* from = waypoints_[first];
  const int end = waypoints_.count() - 1;
  const int stride = (end - first - 2) / kBatch + 1;
  const int count = (end - first - 2) / stride + 1;
  for (int i = 0; i < count; ++i) {
    space.difference(from, waypoints_[end - i * stride], delta_.data());
    for (int j = 0; j < joints_; ++j) state(i)[j] = from[j] + 0.5f * delta_[as_index(j)];
  }
  check_middles(count);
  for (int i = 0, tries = 0; i < count && tries < kMostPruned; ++i) {
    if (is_free_[as_index(i)] == 0) continue;
    const int last = end - i * stride;
    space.difference(from, waypoints_[last], delta_.data());
    rows_.assign(from, from + joints_);
    for (int j = 0; j < joints_; ++j) rows_.push_back(from[j] + delta_[as_index(j)]);
    if (is_free(rows_, first, last)) return last;
    ++tries;
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
    rows_.push_back(is_among(joints, j) ? q[j] + step * whole : q[j]);
  }
  rows_.insert(rows_.end(), b, b + joints_);
  if (!is_free(rows_, k - 1, k + 1)) return false;
  replace(k - 1, k + 1, {rows_.data() + joints_, as_index(is_dropped ? 0 : joints_)});
  return true;
}

/// Writes the straightened stretch, with its ends, into rows_.
void Shortener::write_rows(const Shortcut& shortcut, PathPoint begin, PathPoint end) {
  const int inner = shortcut.joints == all_joints_ ? 0 : end.motion - begin.motion;
  rows_.resize(as_index((inner + 2) * joints_));
  float *from = rows_.data(), *to = from + (inner + 1) * joints_;
  waypoints_.write(begin, from);
  waypoints_.write(end, to);
  const float length = shortcut.end - shortcut.begin;
  for (int i = 1; i <= inner; ++i) {
    const float fraction = (waypoints_.arc_length(begin.motion + i) - shortcut.begin) / length;
    const float* q = waypoints_[begin.motion + i];
    for (int j = 0; j < joints_; ++j) {
      const bool is_straight = is_among(shortcut.joints, j);
      from[i * joints_ + j] = is_straight ? from[j] + fraction * (to[j] - from[j]) : q[j];
    }
  }
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
    shortcut.probe = contacts_.probe(shortcut.begin, shortcut.end);
  }
  return shortcuts;
}

/// Takes free shortcuts of a batch that do not overlap, largest gain first. A shortcut that is in
/// contact where it is probed costs one lane only.
void Shortener::take_shortcuts(bool has_all_joints) {
  std::array<Shortcut, kShortcuts> shortcuts = sample_shortcuts(has_all_joints);
  const float least = least_gain_ * waypoints_.length();
  checker_.rate_shortcuts(waypoints_.view(), least, shortcuts);
  const auto gains = [&](const Shortcut& shortcut) { return shortcut.gain >= least; };
  if (std::ranges::none_of(shortcuts, gains)) return;
  counters_.states += kBatch;
  const auto end = std::partition(shortcuts.begin(), shortcuts.end(),
                                  [](const auto& shortcut) { return shortcut.is_promising; });
  std::sort(shortcuts.begin(), end, [](const auto& a, const auto& b) { return a.gain > b.gain; });
  for (auto taken = shortcuts.begin(); taken != end && !is_stopped(); ++taken) {
    if (!taken->is_promising || !take(*taken)) continue;
    for (auto other = taken + 1; other != end; ++other) follow(*taken, *other);
  }
}

/// Moves a shortcut along with the path after another was taken, or drops it where they overlap.
void Shortener::follow(const Shortcut& taken, Shortcut& other) {
  if (other.begin >= taken.end) {
    other.begin -= taken.gain;
    other.end -= taken.gain;
  } else if (other.end > taken.begin) {
    other.is_promising = false;
  }
}

bool Shortener::take(const Shortcut& shortcut) {
  const PathPoint begin = waypoints_.locate(shortcut.begin), end = waypoints_.locate(shortcut.end);
  if (begin.motion == end.motion) return false;
  write_rows(shortcut, begin, end);
  if (!is_free(rows_, begin.motion, end.motion + 1)) {
    if (contact_) contacts_.add(arc_length_of(*contact_, shortcut, begin));
    return false;
  }
  // The stretch begins between checked states of its old motion.
  const std::span<const float> first(rows_.data(), as_index(joints_));
  if (effort_.refinement >= 1 && !checker_.is_motion_valid(first, first, counters_)) return false;
  replace(begin.motion, end.motion + 1, rows_);
  return true;
}

/// The arc length of the path that corresponds to a point of rows_.
float Shortener::arc_length_of(PathPoint point, const Shortcut& shortcut, PathPoint begin) const {
  const int motions = static_cast<int>(rows_.size()) / joints_ - 1;
  const auto at = [&](int row) {
    if (row == 0) return shortcut.begin;
    return row == motions ? shortcut.end : waypoints_.arc_length(begin.motion + row);
  };
  const float from = at(point.motion);
  return from + point.fraction * (at(point.motion + 1) - from);
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
