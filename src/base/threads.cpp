// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/threads.h"

#include "mneme/base.h"

#include <sched.h>
#include <sys/resource.h>
#include <algorithm>
#include <exception>
#include <mutex>
#include <system_error>
#include <utility>

namespace mneme {
namespace {

thread_local const InterruptScope* innermost = nullptr;

}  // namespace

InterruptScope::InterruptScope(std::function<bool()> is_over)
    : is_over_(std::move(is_over)), outer_(std::exchange(innermost, this)) {}

InterruptScope::~InterruptScope() { innermost = outer_; }

namespace internal {

void poll_interrupt() {
  if (innermost != nullptr && innermost->is_over()) throw Interrupted();
}

void give_way() {
#ifdef __linux__             // where priorities are those of threads
  constexpr int kNice = 10;  // a tenth of a core beside a busy thread
  const sched_param none{};
  static_cast<void>(sched_setscheduler(0, SCHED_BATCH, &none));
  const int lower = std::max(kNice, getpriority(PRIO_PROCESS, 0));
  static_cast<void>(setpriority(PRIO_PROCESS, 0, lower));
#endif
}

struct Threads::Shared {
  std::function<void()> work;
  std::mutex mutex;
  std::exception_ptr thrown;
};

Threads::Threads(std::size_t count, std::function<void()> work)
    : shared_(std::make_shared<Shared>()) {
  shared_->work = std::move(work);
  threads_.reserve(count);
  const auto run = [shared = shared_, scope = innermost] {
    innermost = scope;
    try {
      shared->work();
    } catch (...) {
      const std::lock_guard lock(shared->mutex);
      if (!shared->thrown) shared->thrown = std::current_exception();
    }
  };
  try {
    while (threads_.size() < count) threads_.emplace_back(run);
  } catch (const std::system_error&) {  // the system has no more threads
  }
}

void Threads::join() {
  threads_.clear();
  if (shared_ && shared_->thrown) std::rethrow_exception(std::exchange(shared_->thrown, nullptr));
}

}  // namespace internal
}  // namespace mneme
