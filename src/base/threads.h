// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Worker threads, and what cancels long work.
#pragma once

#include "mneme/base.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <thread>
#include <type_traits>
#include <vector>

namespace mneme::internal {

/// Throws Interrupted if `is_over` of an InterruptScope of this thread returns true. Call it every
/// few milliseconds in long work without a cancel flag. Costs a nanosecond without a scope.
void poll_interrupt();

/// Lets threads of normal priority go first: work that nobody waits for does not delay theirs on
/// the same core. For the calling thread; does nothing where the system has no such priority.
void give_way();

/// Up to `count` threads that each call `work`; fewer or none if the system refuses more. The
/// threads share the InterruptScope of the thread that makes this object. The destructor joins
/// them.
class Threads {
 public:
  Threads() = default;
  Threads(std::size_t count, std::function<void()> work);

  [[nodiscard]] std::size_t size() const { return threads_.size(); }
  /// Joins all threads, then rethrows the first exception that ended one of them, such as
  /// std::bad_alloc.
  void join();

 private:
  struct Shared;
  /// Joins when destroyed, as std::jthread does, which libc++ lacks.
  struct JoiningThread : std::thread {
    using std::thread::thread;
    JoiningThread(JoiningThread&&) = default;
    ~JoiningThread() {
      if (joinable()) join();
    }
  };
  std::shared_ptr<Shared> shared_;
  std::vector<JoiningThread> threads_;
};

/// Calls `work(i)` for each i < count, in any order, from this thread and up to `threads` - 1
/// others. Rethrows the first exception of one of them.
template <class Work>
void run_parallel(std::size_t count, std::size_t threads, const Work& work) {
  std::atomic<std::size_t> next = 0;
  const auto run = [&] {
    for (std::size_t i = next++; i < count; i = next++) work(i);
  };
  const std::size_t most = std::min(threads, count);
  Threads others(most > 1 ? most - 1 : 0, run);
  run();
  others.join();
}

/// Returns the result of `work`, for threads that must outlive a lack of memory. Error: io, with
/// what the std::exception says that ended it.
template <class Work>
auto without_ending(const Work& work) -> decltype(work()) {
  try {
    return work();
  } catch (const std::exception& error) {
    return fail(ErrorCode::io, error.what());
  }
}

/// Returns the value of the flag; false for a null pointer.
[[nodiscard]] inline bool is_set(const std::atomic<bool>* flag) {
  return flag != nullptr && flag->load(std::memory_order_relaxed);
}

/// Returns the result of `work`; nothing if `cancel`, which may be null, interrupted it.
template <class Work>
[[nodiscard]] std::optional<std::invoke_result_t<Work>> unless_cancelled(
    const std::atomic<bool>* cancel, const Work& work) {
  const auto is_cancelled = [&] { return is_set(cancel); };
  const InterruptScope scope(is_cancelled);
  try {
    return work();
  } catch (const Interrupted&) {
    if (!is_cancelled()) throw;  // a scope of the caller is over
    return std::nullopt;
  }
}

}  // namespace mneme::internal
