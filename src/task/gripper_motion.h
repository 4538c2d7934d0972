// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Motions of joints outside of the group between two stages.
#pragma once

#include "task/follow.h"

#include <memory>

namespace mneme::internal {

/// The motion of a gripper stage, proven free.
using GripperMotionPtr = std::shared_ptr<const GripperMotion>;

/// Returns the straight motion of the stage's joints while the group stays at `q`; null if none of
/// them moves. A touch that the ends of lines may have, this motion may leave or enter. `world`
/// is the one before the stage.
[[nodiscard]] tl::expected<GripperMotionPtr, Failure> move_gripper(TaskRun& run,
                                                                   const CheckedWorld& world,
                                                                   const Stage& stage,
                                                                   const Configuration& q);

}  // namespace mneme::internal
