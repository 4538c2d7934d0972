// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The kernels' interface: one table of functions per instruction set.
#pragma once

#include "mneme/base.h"

#include "collision/tables.h"

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

struct CollisionKernels {
  int lanes = 1;
  /// True if the states from + k delta / n, k = 1..n, are free, with n the least multiple of
  /// `lanes` that is at least `states`. Adds the number of states looked at to `states_checked`.
  /// `margin` inflates the robot against obstacles.
  bool (*is_motion_free)(const RobotTables& robot, const SceneTables& scene, const float* from,
                         const float* delta, int states, float margin,
                         std::uint64_t& states_checked) = nullptr;
  /// The same of all motions of a chain, which share vectors: motion i is looked at in its
  /// `states[i]` states, no more.
  bool (*is_chain_free)(const RobotTables& robot, const SceneTables& scene,
                        const MotionChain& chain, float margin,
                        std::uint64_t& states_checked) = nullptr;
  /// `is_free[i]` tells of row i of `states`, which has `count` rows of joint_count values.
  void (*check_states)(const RobotTables& robot, const SceneTables& scene, const float* states,
                       int count, float margin, std::uint8_t* is_free) = nullptr;
};

/// The kernels of an instruction set that this machine has.
[[nodiscard]] const CollisionKernels& collision_kernels(Isa isa);

}  // namespace mneme::internal
