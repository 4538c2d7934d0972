// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Compiled once per instruction set. A vector holds one configuration per lane.
#include "collision/collision_kernels.h"

#include <algorithm>
#include <bit>
#include <cassert>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/collision_kernels.cpp"  // NOLINT
#include "hwy/foreach_target.h"

#include "collision/state_checker-inl.h"
#include "simd/dispatch.h"
#include "simd/intervals-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mneme::internal {
namespace HWY_NAMESPACE {
namespace {

bool is_motion_free(const RobotTables& robot, const SceneTables& scene, const float* from,
                    const float* delta, int states, float margin, CheckCounters& counters) {
  const Tag d;
  const int blocks = std::max(1, (states + kLanes - 1) / kLanes);
  const float step = 1.0f / static_cast<float>(blocks * kLanes);
  const EvenMargins margins(margin);
  StateChecker<true> checker(robot, scene, margins, counters);
  V q[kMaxFrames];
  // The first vector is spread over the motion, its last lane at the far end, where a motion is
  // blocked most often. The rest goes from one end to the other: neighbouring states have small
  // bounding boxes.
  const V lanes = hn::Iota(d, 0.0f);
  const V spacing = splat(static_cast<float>(blocks));
  for (int block = 0; block < blocks; ++block) {
    V state = hn::Mul(hn::Add(lanes, splat(1.0f)), spacing);
    if (block > 0) {
      const V rank = hn::Add(lanes, splat(static_cast<float>((block - 1) * kLanes)));
      const V passed = hn::Floor(hn::Div(hn::Add(rank, splat(0.5f)), splat(blocks - 1.0f)));
      state = hn::Add(hn::Add(rank, passed), splat(1.0f));
    }
    const V fraction = hn::Mul(state, splat(step));
    for (int j = 0; j < robot.joint_count; ++j) {
      q[j] = hn::MulAdd(fraction, splat(delta[j]), splat(from[j]));
    }
    counters.states += static_cast<std::uint64_t>(kLanes);
    Verdict<true> verdict;
    if (checker.check(q, verdict)) return false;
  }
  return true;
}

/// Poses states of a chain of motions: `number` counts them from 1 on, in increasing order.
HWY_INLINE void pose_chain(const MotionChain& chain, int joint_count, V number, V* q) {
  const float first = hn::GetLane(number), last = hn::ExtractLane(number, kLanes - 1);
  float passed = 0;  // states of the motions before
  for (int i = 0; i < chain.count && passed < last; ++i) {
    const auto count = static_cast<float>(chain.states[i]);
    if (first <= passed + count) {
      const float* from = chain.points + i * joint_count;
      const float* delta = chain.deltas + i * joint_count;
      const M is_here = hn::Gt(number, splat(passed));
      const V fraction = hn::Mul(hn::Sub(number, splat(passed)), splat(1.0f / count));
      for (int j = 0; j < joint_count; ++j) {
        const V value = hn::MulAdd(fraction, splat(delta[j]), splat(from[j]));
        q[j] = passed < first ? value : hn::IfThenElse(is_here, value, q[j]);
      }
    }
    passed += count;
  }
}

/// A state of a chain that is hit, in the middle of those that are.
PathPoint find_contact(const MotionChain& chain, V number, M hit) {
  const unsigned bits = bits_of(hit);
  const int middle = (std::countr_zero(bits) + static_cast<int>(std::bit_width(bits)) - 1) / 2;
  const int lane = middle + std::countr_zero(bits >> middle);
  HWY_ALIGN float numbers[kLanes];
  hn::Store(number, Tag(), numbers);
  float rest = numbers[lane];
  int motion = 0;
  for (; motion + 1 < chain.count && rest > static_cast<float>(chain.states[motion]); ++motion) {
    rest -= static_cast<float>(chain.states[motion]);
  }
  return {motion, std::min(rest / static_cast<float>(chain.states[motion]), 1.0f)};
}

bool is_chain_free(const RobotTables& robot, const SceneTables& scene, const MotionChain& chain,
                   float margin, CheckCounters& counters, PathPoint& contact) {
  const Tag d;
  std::int64_t states = 0;
  for (int i = 0; i < chain.count; ++i) states += chain.states[i];
  const std::int64_t blocks = (states + kLanes - 1) / kLanes;
  const EvenMargins margins(margin);
  StateChecker<true> checker(robot, scene, margins, counters);
  V q[kMaxFrames];
  // In the order of is_motion_free; lanes beyond the last state repeat it.
  const V lanes = hn::Iota(d, 0.0f);
  const V spacing = splat(static_cast<float>(blocks)), most = splat(static_cast<float>(states));
  for (std::int64_t block = 0; block < blocks; ++block) {
    V number = hn::Mul(hn::Add(lanes, splat(1.0f)), spacing);
    if (block > 0) {
      const V rank = hn::Add(lanes, splat(static_cast<float>((block - 1) * kLanes)));
      const V skipped =
          hn::Floor(hn::Div(hn::Add(rank, splat(0.5f)), hn::Sub(spacing, splat(1.0f))));
      number = hn::Add(hn::Add(rank, skipped), splat(1.0f));
    }
    number = hn::Min(number, most);
    pose_chain(chain, robot.joint_count, number, q);
    counters.states += static_cast<std::uint64_t>(kLanes);
    Verdict<true> verdict;
    if (!checker.check(q, verdict)) continue;
    contact = find_contact(chain, number, verdict.hit);
    return false;
  }
  return true;
}

/// Loads the motions of `numbers`, one per lane.
HWY_INLINE void load_motions(const SweptChain& chain, int joint_count, const std::int32_t* numbers,
                             LaneMotions& motions) {
  const hn::RebindToSigned<Tag> di;
  const auto number = hn::Load(di, numbers);
  const auto first = hn::Mul(number, hn::Set(di, joint_count));
  motions.number = hn::ConvertTo(Tag(), number);
  for (int j = 0; j < joint_count; ++j) {
    motions.from[j] = hn::GatherIndex(Tag(), chain.points + j, first);
    motions.delta[j] = hn::GatherIndex(Tag(), chain.deltas + j, first);
  }
}

/// Pushes the halves of intervals that are hit. Returns true if one of them is of the shortest.
HWY_INLINE bool halve_hits(const Intervals& open, int count, const float* hits, float least_half,
                           IntervalStack& stack) {
  bool has_shortest = false;
  for (int lane = 0; lane < count; ++lane) {
    if (hits[lane] == 0) continue;
    const float half = 0.5f * open.halves[lane];
    if (open.halves[lane] <= least_half) {
      has_shortest = true;
    } else {
      stack.push(open.motions[lane], open.middles[lane] - half, half);
      stack.push(open.motions[lane], open.middles[lane] + half, half);
    }
  }
  return has_shortest;
}

bool is_sweep_free(const RobotTables& robot, const SceneTables& scene, const SweptChain& chain,
                   CheckCounters& counters) {
  const Tag d;
  assert(chain.intervals >= 1 && chain.margin >= 0 && chain.obstacle_margin >= 0);
  SweptMargins margins(robot, chain);
  StateChecker<false, SweptMargins> checker(robot, scene, margins, counters);
  V q[kMaxFrames];
  LaneMotions motions;
  Intervals open;
  HWY_ALIGN float hits[kLanes];
  const auto find_hits = [&](V middle, V half) {
    margins.set_intervals(middle, half, hn::GetLane(hn::MaxOfLanes(d, half)));
    counters.states += static_cast<std::uint64_t>(kLanes);
    Verdict<false> verdict;
    checker.check(q, verdict);
    hn::Store(hn::IfThenElseZero(verdict.hit, splat(1.0f)), d, hits);
    return !hn::AllFalse(d, verdict.hit);
  };
  // Where a chain is blocked, it mostly is at the state in the middle of an interval.
  bool must_look = chain.count > 1;
  bool is_loaded = false;
  for (IntervalStack stack(chain.count, chain.intervals); !stack.is_empty();) {
    const int count = stack.pop(open);
    if (!is_loaded) {
      load_motions(chain, robot.joint_count, open.motions, motions);
      margins.set_motions(motions);
    }
    is_loaded = chain.count == 1;
    const V middle = hn::Load(d, open.middles);
    for (int j = 0; j < robot.joint_count; ++j) {
      q[j] = hn::MulAdd(middle, motions.delta[j], motions.from[j]);
    }
    if (!find_hits(middle, hn::Load(d, open.halves))) continue;
    const bool has_shortest = halve_hits(open, count, hits, chain.least_half, stack);
    if (!has_shortest && !must_look) continue;
    // The shortest intervals are decided by the state in their middle.
    find_hits(middle, hn::Zero(d));
    for (int lane = 0; lane < count; ++lane) {
      if (hits[lane] != 0 && (must_look || open.halves[lane] <= chain.least_half)) return false;
    }
    must_look = false;
  }
  return true;
}

void check_states(const RobotTables& robot, const SceneTables& scene, const float* states,
                  int count, float margin, std::uint8_t* is_free, CheckCounters& counters) {
  const Tag d;
  const hn::RebindToSigned<Tag> di;
  const EvenMargins margins(margin);
  StateChecker<false> checker(robot, scene, margins, counters);
  V q[kMaxFrames];
  HWY_ALIGN float column[kLanes];
  for (int begin = 0; begin < count; begin += kLanes) {
    // Lanes beyond the last row repeat it.
    const auto row = hn::Min(hn::Iota(di, begin), hn::Set(di, count - 1));
    const auto first = hn::Mul(row, hn::Set(di, robot.joint_count));
    for (int j = 0; j < robot.joint_count; ++j) q[j] = hn::GatherIndex(d, states + j, first);
    Verdict<false> verdict;
    checker.check(q, verdict);
    hn::Store(hn::IfThenElseZero(verdict.hit, splat(1.0f)), d, column);
    for (int lane = 0; lane < kLanes && begin + lane < count; ++lane) {
      is_free[begin + lane] = column[lane] == 0.0f;
    }
  }
}

const CollisionKernels& kernels() {
  static const CollisionKernels table = {kLanes, &is_motion_free, &is_chain_free, &is_sweep_free,
                                         &check_states};
  return table;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace mneme::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
MNEME_EXPORT(const CollisionKernels&, collision_kernels, kernels)
#endif
