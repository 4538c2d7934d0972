// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Inverse kinematics from many seeds at once: one function per instruction set.
#pragma once

#include "mneme/base.h"

#include "tables/tables.h"

#include <array>

namespace mneme::internal {

/// A region of poses around a frame G, for a frame T of the robot.
struct IkTarget {
  std::array<float, 9> rotation = {};     ///< row-major, from the robot's root to G
  std::array<float, 3> translation = {};  ///< the root's origin in G
  int frame = 0;                          ///< frame of the tables that carries T
  std::array<float, 9> tip_rotation = {};
  std::array<float, 3> tip_translation = {};
  /// Half extents of the region of T's origin along the axes of G, metres.
  std::array<float, 3> box = {};
  /// Largest lean of T's z axis from G's z axis, and largest turn of T about that axis, as 2
  /// sin(angle / 2). 2: any.
  float lean = 0, turn = 0;
  float near_m = 0, near_chord = 0;  ///< smaller errors (see IkError) count as none
};

/// Arrays per joint, or rows of joint_count values.
struct IkTask {
  const IkTarget* target = nullptr;
  const float* lower = nullptr;  ///< infinite for joints that wrap
  const float* upper = nullptr;
  const float* seeds = nullptr;
  int count = 0;   ///< number of seeds
  int rounds = 0;  ///< largest number of steps from a seed
  int enough = 0;  ///< number of seeds that reach the target, after which the kernel returns
};

/// The final error of a seed: metres from the region, and the norm of the excesses over
/// IkTarget::lean and ::turn, as 2 sin(angle / 2). Infinite if not tried.
struct IkError {
  float position = 0, rotation = 0;
};

/// Writes a row and an error per seed that was tried.
using IkKernel = void (*)(const RobotTables& chain, const IkTask& request, float* rows,
                          IkError* errors);

/// Returns the kernel for an instruction set that this machine has. The chain's tables need frames
/// only and have at most kMostWalkingJoints joints.
[[nodiscard]] IkKernel ik_kernel(Isa isa);

}  // namespace mneme::internal
