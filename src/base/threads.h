// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Threads, as far as the system has them, and flags by which other threads end what takes long.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

namespace mneme::internal {

/// Threads that each call `work`: up to `count`, fewer or none where the system refuses. The
/// destructor joins them.
class Threads {
 public:
  Threads() = default;
  Threads(std::size_t count, std::function<void()> work);

  [[nodiscard]] std::size_t size() const { return threads_.size(); }
  /// Joins all threads, then rethrows the first exception that ended one of them: memory may run
  /// out in any thread, and the caller of the library is to know.
  void join();

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;
  std::vector<std::jthread> threads_;
};

/// False without a flag.
[[nodiscard]] inline bool is_set(const std::atomic<bool>* flag) {
  return flag != nullptr && flag->load(std::memory_order_relaxed);
}

}  // namespace mneme::internal
