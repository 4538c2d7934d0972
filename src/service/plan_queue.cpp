// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "service/plan_queue.h"

#include <algorithm>
#include <chrono>

namespace mneme::internal {
namespace {

constexpr std::chrono::milliseconds kPollFlag{10};

}  // namespace

std::optional<PlanQueue::Turn> PlanQueue::wait_for_turn(const std::atomic<bool>& is_cancelled,
                                                        int threads, bool is_alone) {
  std::unique_lock lock(mutex_);
  Waiter waiter{threads, is_alone};
  waiters_.push_back(&waiter);
  serve();
  const bool is_full = !waiter.has_turn && static_cast<int>(waiters_.size()) > most_waiting_;
  while (!waiter.has_turn && !is_cancelled && !is_full) {
    waiter.wake.wait_for(lock, kPollFlag, [&] { return waiter.has_turn; });
  }
  if (waiter.has_turn) return Turn(*this, threads, is_alone);
  std::erase(waiters_, &waiter);
  serve();
  return std::nullopt;
}

void PlanQueue::give_back(int threads, bool is_alone) {
  const std::lock_guard lock(mutex_);
  free_ += threads;
  if (is_alone) is_one_alone_ = false;
  serve();
}

void PlanQueue::serve() {
  for (auto next = waiters_.begin(); next != waiters_.end();) {
    Waiter& waiter = **next;
    if (waiter.is_alone && is_one_alone_) {
      ++next;
      continue;
    }
    if (waiter.threads > free_) return;
    next = waiters_.erase(next);
    free_ -= waiter.threads;
    is_one_alone_ = is_one_alone_ || waiter.is_alone;
    // The waiter cannot return before the lock is released.
    waiter.has_turn = true;
    waiter.wake.notify_one();
  }
}

int PlanQueue::waiting() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(waiters_.size());
}

}  // namespace mneme::internal
