// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Long calls: without the global interpreter lock, and ended by Control-C.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

namespace mneme::python {

/// A thread that waits for work, because starting one takes longer than many a plan.
class Worker {
 public:
  Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;
  ~Worker();

  /// Runs `work` in the thread, and returns once it is done. Meanwhile calls `on_wait` every 50 ms.
  void run(const std::function<void()>& work, const std::function<void()>& on_wait);

 private:
  void serve();

  std::mutex mutex_;
  std::condition_variable changed_;
  const std::function<void()>* work_ = nullptr;  ///< null once it is done
  bool is_ending_ = false;
  std::thread thread_;
};

/// Runs `work` in another thread, the same one for all calls of this thread. Not under the lock.
void run_elsewhere(const std::function<void()>& work, const std::function<void()>& on_wait);

/// Runs `work()` in another thread without the lock. If a signal's handler raises in the meantime,
/// as that of Control-C does, `cancel` is set, and the exception is raised once `work` has
/// returned. `work` does not throw and heeds the flag.
template <class Work>
auto run_interruptible(std::atomic<bool>& cancel, Work work) {
  std::optional<decltype(work())> result;
  bool is_raised = false;
  {
    const pybind11::gil_scoped_release released;
    run_elsewhere([&] { result.emplace(work()); },
                  [&] {
                    if (is_raised) return;
                    const pybind11::gil_scoped_acquire acquired;
                    is_raised = PyErr_CheckSignals() != 0;
                    if (is_raised) cancel = true;
                  });
  }
  if (is_raised) throw pybind11::error_already_set();
  return *std::move(result);
}

}  // namespace mneme::python
