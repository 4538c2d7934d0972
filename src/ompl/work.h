// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mneme/ompl.h"

#include <memory>
#include <span>
#include <vector>

namespace mneme::ompl {

inline void count_states(const std::shared_ptr<WorkCounters>& counters, std::uint64_t states) {
  if (counters) counters->states.fetch_add(states, std::memory_order_relaxed);
}
inline void count_motion(const std::shared_ptr<WorkCounters>& counters, std::uint64_t states) {
  if (!counters) return;
  counters->states.fetch_add(states, std::memory_order_relaxed);
  counters->motions.fetch_add(1, std::memory_order_relaxed);
}

/// A configuration of the robot to write into, one per thread and slot: OMPL's threads share
/// validity checkers, and allocating would cost as much as checking a state.
template <int slot>
std::span<float> scratch(const Robot& robot) {
  thread_local std::vector<float> values;
  values.resize(static_cast<std::size_t>(robot.joint_count()));
  return values;
}

}  // namespace mneme::ompl
