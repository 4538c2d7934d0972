// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Long calls that release the global interpreter lock and end at Control-C.
#pragma once

#include "mneme/base.h"

#include <pybind11/pybind11.h>

#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace mneme::python {

/// A waiting thread. Starting one takes longer than many plans.
class Worker {
 public:
  Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;
  ~Worker();

  /// Runs `work` in the thread, waits for it and rethrows its exceptions. Calls `on_wait` every 50
  /// ms meanwhile.
  void run(const std::function<void()>& work, const std::function<void()>& on_wait);

 private:
  void serve();

  std::mutex mutex_;
  std::condition_variable changed_;
  const std::function<void()>* work_ = nullptr;  ///< null when done
  std::exception_ptr thrown_;
  bool is_ending_ = false;
  std::thread thread_;
};

/// Runs `work` in another thread, which calls from this thread share. Call without the interpreter
/// lock.
void run_elsewhere(const std::function<void()>& work, const std::function<void()>& on_wait);

/// Runs `work()` in another thread without the interpreter lock. If a signal handler raises, as for
/// Control-C, sets `cancel`, interrupts work within an InterruptScope and raises the exception when
/// `work` has returned.
template <class Work>
auto run_interruptible(std::atomic<bool>& cancel, Work work) {
  std::optional<decltype(work())> result;
  std::atomic<bool> is_raised = false;
  const auto run = [&] {
    const InterruptScope scope([&] { return is_raised.load(); });
    try {
      result.emplace(work());
    } catch (const Interrupted&) {
      // The exception of the handler is raised below.
    }
  };
  {
    const pybind11::gil_scoped_release released;
    run_elsewhere(run, [&] {
      if (is_raised) return;
      const pybind11::gil_scoped_acquire acquired;
      is_raised = PyErr_CheckSignals() != 0;
      if (is_raised) cancel = true;
    });
  }
  if (is_raised) throw pybind11::error_already_set();
  return *std::move(result);
}

/// The same for work without a cancel flag.
template <class Work>
auto run_interruptible(Work work) {
  std::atomic<bool> cancel = false;
  return run_interruptible(cancel, std::move(work));
}

}  // namespace mneme::python
