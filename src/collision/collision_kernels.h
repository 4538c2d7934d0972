// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The kernels' interface: one table of functions per instruction set.
#pragma once

#include "mneme/collision.h"

#include "tables/tables.h"

#include <cstdint>

namespace mneme::internal {

/// Rough costs in the unit of CheckCounters::work, of one vector.
inline constexpr std::uint64_t kStateWork = 150;  ///< frames of a state, and links among each other
inline constexpr std::uint64_t kTestWork = 8;     ///< a body or group against an obstacle
inline constexpr std::uint64_t kRoundWork = 300;  ///< frames, pulls and solution of a walk's round
inline constexpr std::uint64_t kPushWork = 60;    ///< spheres of a group against an obstacle
inline constexpr std::uint64_t kRowWork = 150;    ///< a row of a walk's equations

/// `count` motions between consecutive rows of `points`. Row i of `deltas` is the whole
/// displacement of motion i. Motion i is checked at `states[i]` >= 1 states.
struct MotionChain {
  const float* points = nullptr;
  const float* deltas = nullptr;
  const int* states = nullptr;
  int count = 0;
};

/// `count` motions that are checked continuously, also between their states. Motion i goes from row
/// i of `points` by row i of `deltas`.
struct SweptChain {
  const float* points = nullptr;
  const float* deltas = nullptr;
  int count = 1;
  /// Displacement bounds of each motion, metres, for each moving body and for the approach of each
  /// pair of bodies. Bodies and pairs with a bound of 0 are not checked.
  const float* body_displacements = nullptr;
  const float* pair_displacements = nullptr;
  float obstacle_margin = 0;  ///< margin to obstacles, metres
  float margin = 0;           ///< margin between bodies, also added to `obstacle_margin`, metres
  /// At an end of the chain that is start or goal of the problem, `margin` is 0. It grows from
  /// there by kMarginGrowth of a body's arc length.
  bool is_from_start = false, is_to_goal = false;
  static constexpr float kMarginGrowth = 0.002f;
  int intervals = 1;  ///< number of equal intervals of a motion that are checked first, at least 1
  /// Half of the shortest interval, as a fraction of the motion; at least 2^-31 of half of a first
  /// interval.
  float least_half = 0;
};

struct CollisionKernels {
  int lanes = 1;
  /// True if n states of a motion are free: from + k delta / n for k = 1..n. n is the least
  /// multiple of `lanes` that is at least `states`. Adds states and work to `counters`. `margin`
  /// inflates the robot against obstacles.
  bool (*is_motion_free)(const RobotTables& robot, const SceneTables& scene, const float* from,
                         const float* delta, int states, float margin,
                         CheckCounters& counters) = nullptr;
  /// is_motion_free for all motions of a chain, which share vectors: motion i has exactly
  /// `states[i]` states. If it returns false, `contact` is a state in contact.
  bool (*is_chain_free)(const RobotTables& robot, const SceneTables& scene,
                        const MotionChain& chain, float margin, CheckCounters& counters,
                        PathPoint& contact) = nullptr;
  /// True if intervals that cover the motions are free. An interval is free if the state in its
  /// middle is, with bodies inflated by their margin and their displacement within the interval.
  /// Intervals that fail are halved. An interval of the shortest length also passes if its middle
  /// is free with the margin alone. Intervals of all motions of a chain share vectors.
  bool (*is_sweep_free)(const RobotTables& robot, const SceneTables& scene, const SweptChain& chain,
                        CheckCounters& counters) = nullptr;
  /// Writes 1 to `is_free[i]` if row i of `states` is free. `states`: `count` rows of joint_count
  /// values.
  void (*check_states)(const RobotTables& robot, const SceneTables& scene, const float* states,
                       int count, float margin, std::uint8_t* is_free,
                       CheckCounters& counters) = nullptr;
};

/// Returns the kernels of an instruction set that this machine has.
[[nodiscard]] const CollisionKernels& collision_kernels(Isa isa);

/// WalkStep of mneme/collision.h as the kernel reads it. Arrays have a value per joint, except
/// `jitter` (three per candidate) and `from` (one row, or one per candidate).
struct WalkRequest {
  const Limb* limb = nullptr;
  int pulled_points = 1;
  float length = 0;
  float clearance = 0;
  const float* from = nullptr;
  int from_stride = 0;  ///< joint_count, or 0 if `from` is one row
  const float* drift = nullptr;
  const float* lower = nullptr;  ///< limits of candidates
  const float* upper = nullptr;
  const float* jitter = nullptr;
  int count = 0;  ///< number of candidates
};

/// Writes one row of joint_count values per candidate. Adds to `counters.work`.
using WalkKernel = void (*)(const RobotTables& robot, const SceneTables& scene,
                            const WalkRequest& request, float* candidates, CheckCounters& counters);

/// Returns the kernel of an instruction set that this machine has.
[[nodiscard]] WalkKernel walk_kernel(Isa isa);

}  // namespace mneme::internal
