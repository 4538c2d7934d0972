// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Compiled once per instruction set. A vector holds one candidate per lane.
#include "collision/shortcut_kernel.h"

#include <algorithm>
#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/shortcut_kernel.cpp"  // NOLINT
#include "hwy/foreach_target.h"

#include "collision/state_checker-inl.h"
#include "simd/dispatch.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {
namespace {

using Bits = hn::RebindToSigned<Tag>;

static_assert(kShortcuts % kLanes == 0);

/// A subset of joints per lane.
class JointSubsets {
 public:
  HWY_INLINE void set(int lane, std::uint64_t joints) {
    low_[lane] = static_cast<std::int32_t>(joints & 0xffffffff);
    high_[lane] = static_cast<std::int32_t>(joints >> 32);
  }
  /// The lanes whose subset holds joint `j`.
  [[nodiscard]] HWY_INLINE M holding(int j) const {
    const Bits d;
    const auto bits = hn::Load(d, j < 32 ? low_ : high_);
    return hn::RebindMask(Tag(), hn::TestBit(bits, hn::Set(d, std::int32_t(1u << j % 32))));
  }

 private:
  HWY_ALIGN std::int32_t low_[kLanes], high_[kLanes];
};

HWY_INLINE V cost_of(const MotionCost& cost, const V* a, const V* b, int joint_count) {
  V sum = hn::Zero(Tag());
  if (cost.pace.empty()) {
    for (int j = 0; j < joint_count; ++j) {
      const V delta = hn::Sub(b[j], a[j]);
      sum = hn::MulAdd(delta, delta, sum);
    }
    return hn::Sqrt(sum);
  }
  V most = sum;
  for (int j = 0; j < joint_count; ++j) {
    const V delta = hn::Mul(hn::Sub(b[j], a[j]), splat(cost.pace[static_cast<size_t>(j)]));
    sum = hn::MulAdd(delta, delta, sum);
    most = hn::Max(most, hn::Abs(delta));
  }
  const V all = hn::Sqrt(sum);
  return hn::MulAdd(splat(MotionCost::kSlowest), hn::Sub(most, all), all);
}

/// The states of a path at an arc length per lane.
HWY_INLINE void pose_on(const PathView& path, int joint_count, V arc_length, V* q) {
  const float *row = path.rows.data(), *direction = path.directions.data();
  const size_t motions = path.arc_lengths.size() - 1;
  for (size_t m = 0; m < motions; ++m, row += joint_count, direction += joint_count) {
    const V begin = splat(path.arc_lengths[m]);
    const M is_here = hn::Ge(arc_length, begin);
    if (m > 0 && hn::AllFalse(Tag(), is_here)) break;
    const V along = hn::Sub(arc_length, begin);
    for (int j = 0; j < joint_count; ++j) {
      const V value = hn::MulAdd(along, splat(direction[j]), splat(row[j]));
      q[j] = m == 0 ? value : hn::IfThenElse(is_here, value, q[j]);
    }
  }
}

/// Stretches of a path, one per lane, in which subsets of joints go straight.
class Stretches {
 public:
  HWY_INLINE Stretches(const PathView& path, int joint_count, const Shortcut* shortcuts)
      : path_(path), joint_count_(joint_count) {
    const Tag d;
    HWY_ALIGN float begins[kLanes], ends[kLanes], probes[kLanes];
    JointSubsets subsets;
    std::uint64_t shared = ~std::uint64_t{0};
    for (int lane = 0; lane < kLanes; ++lane) {
      begins[lane] = shortcuts[lane].begin;
      ends[lane] = shortcuts[lane].end;
      probes[lane] = shortcuts[lane].probe;
      subsets.set(lane, shortcuts[lane].joints);
      shared &= shortcuts[lane].joints;
    }
    is_straight_ = std::popcount(shared) >= joint_count;
    for (int j = 0; j < joint_count && !is_straight_; ++j) goes_straight_[j] = subsets.holding(j);
    begin_ = hn::Load(d, begins);
    end_ = hn::Load(d, ends);
    probe_ = hn::Load(d, probes);
    pose_on(path, joint_count, begin_, from_);
    pose_on(path, joint_count, end_, to_);
    for (int j = 0; j < joint_count; ++j) way_[j] = hn::Sub(to_[j], from_[j]);
  }

  /// How much shorter each stretch becomes.
  [[nodiscard]] HWY_INLINE V gains() const {
    const V before = hn::Sub(end_, begin_);
    if (is_straight_) return hn::Sub(before, cost_of(path_.cost, from_, to_, joint_count_));
    const Tag d;
    const V inverse = hn::Div(splat(1.0f), hn::Max(before, splat(1e-9f)));
    V length = hn::Zero(d);
    V last[kMaxFrames], next[kMaxFrames];
    for (int j = 0; j < joint_count_; ++j) last[j] = from_[j];
    for (size_t i = 1; i + 1 < path_.arc_lengths.size(); ++i) {
      const V at = splat(path_.arc_lengths[i]);
      const M is_inside = hn::And(hn::Lt(begin_, at), hn::Lt(at, end_));
      if (hn::AllFalse(d, is_inside)) continue;
      const V fraction = hn::Mul(hn::Sub(at, begin_), inverse);
      const float* row = path_.rows.data() + i * static_cast<size_t>(joint_count_);
      for (int j = 0; j < joint_count_; ++j) next[j] = straight_or(splat(row[j]), fraction, j);
      const V step = cost_of(path_.cost, last, next, joint_count_);
      length = hn::Add(length, hn::IfThenElseZero(is_inside, step));
      for (int j = 0; j < joint_count_; ++j) last[j] = hn::IfThenElse(is_inside, next[j], last[j]);
    }
    length = hn::Add(length, cost_of(path_.cost, last, to_, joint_count_));
    return hn::Sub(before, length);
  }

  HWY_INLINE void write_probes(V* q) const {
    if (is_straight_) {
      for (int j = 0; j < joint_count_; ++j) q[j] = straight(probe_, j);
      return;
    }
    pose_on(path_, joint_count_, hn::MulAdd(probe_, hn::Sub(end_, begin_), begin_), q);
    for (int j = 0; j < joint_count_; ++j) q[j] = straight_or(q[j], probe_, j);
  }

 private:
  [[nodiscard]] HWY_INLINE V straight(V fraction, int j) const {
    return hn::MulAdd(fraction, way_[j], from_[j]);
  }
  /// The value of joint `j` on the way from end to end where it goes straight, else `value`.
  [[nodiscard]] HWY_INLINE V straight_or(V value, V fraction, int j) const {
    return hn::IfThenElse(goes_straight_[j], straight(fraction, j), value);
  }

  const PathView& path_;
  int joint_count_;
  bool is_straight_ = false;     ///< all joints, in all lanes
  M goes_straight_[kMaxFrames];  ///< by joint; not set if `is_straight_`
  V begin_, end_, probe_;
  V from_[kMaxFrames], to_[kMaxFrames], way_[kMaxFrames];
};

/// Candidates with their states and gains. Only those that gain enough are checked; with fewer
/// lanes than candidates they share vectors.
class Candidates {
 public:
  HWY_INLINE Candidates(int joint_count, float least_gain)
      : joint_count_(joint_count), least_gain_(least_gain) {}

  /// Sets as many candidates as a vector has lanes.
  HWY_INLINE void set_gains(int begin, V gain) { hn::Store(gain, Tag(), gains_ + begin); }
  HWY_INLINE void set_states(int begin, const V* q) {
    for (int j = 0; j < joint_count_; ++j) hn::Store(q[j], Tag(), columns_[j] + begin);
  }
  [[nodiscard]] HWY_INLINE float gain(int candidate) const { return gains_[candidate]; }

  /// Lists the candidates to check. Call before those below.
  HWY_INLINE void list() {
    count_ = 0;
    for (int i = 0; i < kShortcuts; ++i) {
      order_[count_] = i;
      count_ += gains_[i] >= least_gain_ ? 1 : 0;
    }
    if (!kIsOneVector || count_ == 0) return;
    for (int i = 0; i < kShortcuts; ++i) order_[i] = i;
    count_ = kShortcuts;
  }
  /// Sorts the list by gain, largest first, unless one vector holds it.
  HWY_INLINE void sort() {
    for (int i = 1; i < count_ && count_ > kLanes; ++i) {
      const int moved = order_[i];
      int place = i;
      for (; place > 0 && gains_[order_[place - 1]] < gains_[moved]; --place) {
        order_[place] = order_[place - 1];
      }
      order_[place] = moved;
    }
  }
  [[nodiscard]] HWY_INLINE int count() const { return count_; }
  [[nodiscard]] HWY_INLINE int operator[](int i) const { return order_[i]; }

  /// Checks kLanes candidates of the list; `is_blocked` has room for a vector. Lanes beyond the
  /// last repeat it. Candidates that gain too little count as blocked.
  HWY_INLINE void check(StateChecker<false>& checker, int begin, float* is_blocked) const {
    const Tag d;
    V q[kMaxFrames];
    for (int j = 0; j < joint_count_; ++j) q[j] = listed(columns_[j], begin);
    Verdict<false> verdict;
    verdict.hit = hn::Lt(listed(gains_, begin), splat(least_gain_));
    checker.check(q, verdict);
    hn::Store(hn::IfThenElseZero(verdict.hit, splat(1.0f)), d, is_blocked);
  }

 private:
  static constexpr bool kIsOneVector = kLanes == kShortcuts;

  [[nodiscard]] HWY_INLINE V listed(const float* values, int begin) const {
    if (kIsOneVector) return hn::Load(Tag(), values);
    HWY_ALIGN float lanes[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) {
      lanes[lane] = values[order_[std::min(begin + lane, count_ - 1)]];
    }
    return hn::Load(Tag(), lanes);
  }

  int joint_count_;
  float least_gain_;
  int count_ = 0;
  int order_[kShortcuts + 1];
  HWY_ALIGN float gains_[kShortcuts];
  HWY_ALIGN float columns_[kMaxFrames][kShortcuts];
};

void rate_shortcuts(const RobotTables& robot, const SceneTables& scene, const PathView& path,
                    float least_gain, float margin, std::span<Shortcut, kShortcuts> shortcuts) {
  Candidates candidates(robot.joint_count, least_gain);
  for (int begin = 0; begin < kShortcuts; begin += kLanes) {
    const Stretches stretches(path, robot.joint_count, &shortcuts[static_cast<size_t>(begin)]);
    const V gain = stretches.gains();
    candidates.set_gains(begin, gain);
    if (hn::AllTrue(Tag(), hn::Lt(gain, splat(least_gain)))) continue;
    V q[kMaxFrames];
    stretches.write_probes(q);
    candidates.set_states(begin, q);
  }
  for (int i = 0; i < kShortcuts; ++i) {
    shortcuts[static_cast<size_t>(i)].gain = candidates.gain(i);
    shortcuts[static_cast<size_t>(i)].is_promising = false;
  }
  candidates.list();
  if (candidates.count() == 0) return;
  const EvenMargins margins(margin);
  CheckCounters ignored;
  StateChecker<false> checker(robot, scene, margins, ignored);
  for (int begin = 0; begin < candidates.count(); begin += kLanes) {
    HWY_ALIGN float is_blocked[kLanes];
    candidates.check(checker, begin, is_blocked);
    for (int i = begin; i < std::min(begin + kLanes, candidates.count()); ++i) {
      shortcuts[static_cast<size_t>(candidates[i])].is_promising = is_blocked[i - begin] == 0;
    }
  }
}

/// The candidates of a relaxation.
HWY_INLINE void set_candidates(const PathView& path, const Relaxation& relaxation, int joints,
                               Candidates& candidates) {
  const auto k = static_cast<size_t>(relaxation.waypoint);
  const float* before = path.rows.data() + (k - 1) * static_cast<size_t>(joints);
  const float *row = before + joints, *after = row + joints;
  const float length = path.arc_lengths[k + 1] - path.arc_lengths[k - 1];
  const float fraction = (path.arc_lengths[k] - path.arc_lengths[k - 1]) / length;
  V a[kMaxFrames], q[kMaxFrames], b[kMaxFrames];
  for (int begin = 0; begin < kShortcuts; begin += kLanes) {
    HWY_ALIGN float steps[kLanes];
    JointSubsets subsets;
    for (int lane = 0; lane < kLanes; ++lane) {
      steps[lane] = relaxation.step(begin + lane);
      subsets.set(lane, relaxation.subset(begin + lane));
    }
    const V step = hn::Load(Tag(), steps);
    for (int j = 0; j < joints; ++j) {
      a[j] = splat(before[j]);
      b[j] = splat(after[j]);
      const float aim = before[j] + fraction * (after[j] - before[j]) - row[j];
      const V moved = hn::MulAdd(step, splat(aim), splat(row[j]));
      q[j] = hn::IfThenElse(subsets.holding(j), moved, splat(row[j]));
    }
    const V left = hn::Add(cost_of(path.cost, a, q, joints), cost_of(path.cost, q, b, joints));
    candidates.set_gains(begin, hn::Sub(splat(length), left));
    candidates.set_states(begin, q);
  }
}

void rate_relaxations(const RobotTables& robot, const SceneTables& scene, const PathView& path,
                      const Relaxation& relaxation, float margin,
                      std::span<float, kShortcuts> gains) {
  Candidates candidates(robot.joint_count, 0);
  set_candidates(path, relaxation, robot.joint_count, candidates);
  candidates.list();
  candidates.sort();
  std::ranges::fill(gains, 0.0f);
  const EvenMargins margins(margin);
  CheckCounters ignored;
  StateChecker<false> checker(robot, scene, margins, ignored);
  bool is_found = false;
  for (int begin = 0; !is_found && begin < candidates.count(); begin += kLanes) {
    HWY_ALIGN float is_blocked[kLanes];
    candidates.check(checker, begin, is_blocked);
    for (int i = begin; i < std::min(begin + kLanes, candidates.count()); ++i) {
      if (is_blocked[i - begin] != 0) continue;
      is_found = true;
      gains[static_cast<size_t>(candidates[i])] = candidates.gain(candidates[i]);
    }
  }
}

const ShortcutKernels& kernels() {
  static const ShortcutKernels table = {&rate_shortcuts, &rate_relaxations};
  return table;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
MNEME_EXPORT(const ShortcutKernels&, shortcut_kernels, kernels)
#endif
