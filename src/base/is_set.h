// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Flags by which other threads end what takes long.
#pragma once

#include <atomic>

namespace mneme::internal {

/// False without a flag.
[[nodiscard]] inline bool is_set(const std::atomic<bool>* flag) {
  return flag != nullptr && flag->load(std::memory_order_relaxed);
}

}  // namespace mneme::internal
