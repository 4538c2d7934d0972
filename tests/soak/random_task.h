// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Random tasks of the Panda: takes a cup from a table and puts it onto the table or a shelf.
#pragma once

#include "mneme/task.h"

#include <cstdint>

namespace mneme::soak {

/// Numbers of alternatives of the approach and of the place.
struct Choices {
  int grasps = 500, placements = 50;
};

/// Returns a random task: approach, grasp, lift, carry, lower, release and retreat. One grasp and
/// one placement alone have a plan. The others are random, many of them in contact or out of reach.
/// Error: no such task in many tries.
[[nodiscard]] Result<Task> random_task(const Robot& panda, const Choices& choices,
                                       std::uint64_t seed);

/// Returns such a task without a plan: the obstacle "slab" is over all placements.
[[nodiscard]] Task blocked_task(const Robot& panda, const Choices& choices, std::uint64_t seed);

}  // namespace mneme::soak
