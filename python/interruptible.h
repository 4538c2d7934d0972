// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Long calls: without the global interpreter lock, and ended by Control-C.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <future>
#include <utility>

namespace mneme::python {

/// Runs `work()` in a thread of its own without the lock. If a signal's handler raises in the
/// meantime, as that of Control-C does, `cancel` is set, and the exception is raised once `work`
/// has returned. `work` does not throw and heeds the flag.
template <class Work>
auto run_interruptible(std::atomic<bool>& cancel, Work work) {
  constexpr std::chrono::milliseconds kPoll(50);
  const pybind11::gil_scoped_release released;
  auto future = std::async(std::launch::async, std::move(work));
  while (future.wait_for(kPoll) != std::future_status::ready) {
    const pybind11::gil_scoped_acquire acquired;
    if (PyErr_CheckSignals() == 0) continue;
    cancel = true;
    {
      const pybind11::gil_scoped_release waiting;
      future.wait();
    }
    throw pybind11::error_already_set();
  }
  return future.get();
}

}  // namespace mneme::python
