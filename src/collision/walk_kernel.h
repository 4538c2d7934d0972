// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Steps of escape walks: one function per instruction set.
#pragma once

#include "mneme/base.h"

#include "tables/tables.h"

namespace mneme::internal {

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

/// That of an instruction set that this machine has.
[[nodiscard]] WalkKernel walk_kernel(Isa isa);

}  // namespace mneme::internal
