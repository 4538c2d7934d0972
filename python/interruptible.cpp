// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "interruptible.h"

#include <unistd.h>
#include <chrono>
#include <memory>

namespace mneme::python {
namespace {

constexpr std::chrono::milliseconds kPoll(50);

/// The worker of a thread. It does not exist in a forked process.
struct OwnWorker {
  OwnWorker() = default;
  OwnWorker(const OwnWorker&) = delete;
  OwnWorker& operator=(const OwnWorker&) = delete;
  ~OwnWorker() { forget_after_fork(); }

  void forget_after_fork() {
    if (process != ::getpid()) static_cast<void>(worker.release());
  }

  std::unique_ptr<Worker> worker;
  pid_t process = 0;
  bool is_busy = false;
};

}  // namespace

Worker::Worker() : thread_([this] { serve(); }) {}

Worker::~Worker() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Worker::serve() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return is_ending_ || work_ != nullptr; });
    if (is_ending_) return;
    lock.unlock();
    try {
      (*work_)();
    } catch (...) {
      thrown_ = std::current_exception();
    }
    lock.lock();
    work_ = nullptr;
    changed_.notify_all();
  }
}

void Worker::run(const std::function<void()>& work, const std::function<void()>& on_wait) {
  std::unique_lock lock(mutex_);
  work_ = &work;
  changed_.notify_all();
  while (!changed_.wait_for(lock, kPoll, [&] { return work_ == nullptr; })) {
    lock.unlock();
    on_wait();
    lock.lock();
  }
  if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
}

void run_elsewhere(const std::function<void()>& work, const std::function<void()>& on_wait) {
  thread_local OwnWorker own;
  // A signal handler may call back while this thread waits.
  if (own.is_busy) return Worker().run(work, on_wait);
  own.forget_after_fork();
  own.process = ::getpid();
  if (own.worker == nullptr) own.worker = std::make_unique<Worker>();
  own.is_busy = true;
  try {
    own.worker->run(work, on_wait);
  } catch (...) {
    own.is_busy = false;
    throw;
  }
  own.is_busy = false;
}

}  // namespace mneme::python
