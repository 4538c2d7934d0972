// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Inverse kinematics from many seeds at once: one function per instruction set.
#pragma once

#include "mneme/base.h"

#include "tables/tables.h"

#include <array>
#include <cstdint>

namespace mneme::internal {

/// The target: a region of poses around a frame G. A frame T of the robot is to be in it.
struct IkTarget {
  std::array<float, 9> rotation = {};     ///< row-major, from the robot's root to G
  std::array<float, 3> translation = {};  ///< the root's origin in G
  int frame = 0;                          ///< of the tables, that carries T
  std::array<float, 9> tip_rotation = {};
  std::array<float, 3> tip_translation = {};
  std::array<float, 3> box = {};  ///< half extents along the axes of G: where T's origin may be
  /// 2 sin(angle / 2) of how far T's z axis may lean from G's, and T may turn about it; 2 is all
  /// the way.
  float lean = 0, turn = 0;
  float near_m = 0, near_rad = 0;  ///< what is left of an error counts as none
};

/// Arrays per joint, or rows of joint_count values.
struct IkTask {
  const IkTarget* target = nullptr;
  const float* lower = nullptr;  ///< infinite for joints that wrap
  const float* upper = nullptr;
  const float* seeds = nullptr;
  int count = 0;   ///< of seeds
  int rounds = 0;  ///< most steps from a seed
  int enough = 0;  ///< of seeds whose configurations reach the target, after which no more is tried
};

/// The error that a seed ended with: metres and radians from the region; infinite if not tried.
struct IkError {
  float position = 0, rotation = 0;
};

/// Writes a row and an error per seed that was tried.
using IkKernel = void (*)(const RobotTables& chain, const IkTask& request, float* rows,
                          IkError* errors);

/// The kernel for an instruction set that this machine has. The chain's tables need frames only and
/// have at most kMostWalkingJoints joints.
[[nodiscard]] IkKernel ik_kernel(Isa isa);

}  // namespace mneme::internal
