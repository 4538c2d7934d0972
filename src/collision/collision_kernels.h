// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The kernels' interface: one table of functions per instruction set.
#pragma once

#include "mneme/base.h"

#include "tables/tables.h"

#include <cstdint>

namespace mneme::internal {

/// Motions from row to row of `points`, whose displacements are the rows of `deltas`: `count` of
/// them, of `states[i]` states each, at least one.
struct MotionChain {
  const float* points = nullptr;
  const float* deltas = nullptr;
  const int* states = nullptr;
  int count = 0;
};

/// A motion that is checked continuously: its states with all that lies between them.
struct SweptMotion {
  const float* from = nullptr;
  const float* delta = nullptr;
  /// Displacement bounds, metres: of the points of each moving body along the motion, and by how
  /// much each pair of bodies comes closer. What does not move is not checked.
  const float* body_displacements = nullptr;
  const float* pair_displacements = nullptr;
  float obstacle_margin = 0;  ///< metres to obstacles
  float margin = 0;           ///< metres to obstacles, too, and between bodies
  /// There, `margin` is 0; a body's grows by this share of its arc length.
  bool is_from_start = false, is_to_goal = false;
  static constexpr float kMarginGrowth = 0.002f;
  int intervals = 1;     ///< equal ones, checked first; at least 1
  float least_half = 0;  ///< of an interval; 1 is the motion. At least 2^-31 of half a first one
};

struct CollisionKernels {
  int lanes = 1;
  /// True if the states from + k delta / n, k = 1..n, are free, with n the least multiple of
  /// `lanes` that is at least `states`. Adds the number of states checked to `states_checked`.
  /// `margin` inflates the robot against obstacles.
  bool (*is_motion_free)(const RobotTables& robot, const SceneTables& scene, const float* from,
                         const float* delta, int states, float margin,
                         std::uint64_t& states_checked) = nullptr;
  /// The same of all motions of a chain, which share vectors: motion i is checked in its
  /// `states[i]` states, no more.
  bool (*is_chain_free)(const RobotTables& robot, const SceneTables& scene,
                        const MotionChain& chain, float margin,
                        std::uint64_t& states_checked) = nullptr;
  /// True if bodies inflated by their margin and by what they move around them touch nothing in
  /// states whose intervals cover the motion. Intervals are halved until they pass; the least pass,
  /// too, if the state in their middle is free with the margin alone.
  bool (*is_sweep_free)(const RobotTables& robot, const SceneTables& scene,
                        const SweptMotion& motion, std::uint64_t& states_checked) = nullptr;
  /// `is_free[i]` tells of row i of `states`, which has `count` rows of joint_count values.
  void (*check_states)(const RobotTables& robot, const SceneTables& scene, const float* states,
                       int count, float margin, std::uint8_t* is_free) = nullptr;
};

/// The kernels of an instruction set that this machine has.
[[nodiscard]] const CollisionKernels& collision_kernels(Isa isa);

/// WalkStep of mneme/collision.h as the kernel reads it. Arrays per joint, but `from`, which may
/// have a row per candidate, and `jitter`: three values a candidate.
struct WalkRequest {
  const Limb* limb = nullptr;
  int pulled_points = 1;
  float length = 0;
  float clearance = 0;
  const float* from = nullptr;
  int from_stride = 0;  ///< to where the next candidate begins; 0: all begin at one
  const float* drift = nullptr;
  const float* lower = nullptr;  ///< candidates stay within
  const float* upper = nullptr;
  const float* jitter = nullptr;
  int count = 0;  ///< of candidates
};

/// Writes rows of joint_count values, a candidate each.
using WalkKernel = void (*)(const RobotTables& robot, const SceneTables& scene,
                            const WalkRequest& request, float* candidates);

/// The kernel of an instruction set that this machine has.
[[nodiscard]] WalkKernel walk_kernel(Isa isa);

}  // namespace mneme::internal
