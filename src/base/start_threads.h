// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Threads, as far as the system has them.
#pragma once

#include <cstddef>
#include <system_error>
#include <thread>
#include <vector>

namespace mneme::internal {

/// Threads that each call a copy of `work`: up to `count`, fewer or none where the system refuses.
/// They are joined when the vector goes.
template <class Work>
[[nodiscard]] std::vector<std::jthread> start_threads(std::size_t count, const Work& work) {
  std::vector<std::jthread> threads;
  try {
    while (threads.size() < count) threads.emplace_back(work);
  } catch (const std::system_error&) {
    return threads;
  }
  return threads;
}

}  // namespace mneme::internal
