// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "service/plan_queue.h"

#include <algorithm>
#include <chrono>

namespace mneme::internal {
namespace {

constexpr std::chrono::milliseconds kLookAtFlag{10};

}  // namespace

std::optional<PlanQueue::Turn> PlanQueue::wait_for_turn(const std::atomic<bool>& is_cancelled,
                                                        int threads) {
  std::unique_lock lock(mutex_);
  if (free_ >= threads && line_.empty()) {
    free_ -= threads;
    return Turn(*this, threads);
  }
  if (static_cast<int>(line_.size()) >= longest_line_) return std::nullopt;
  Waiter waiter{threads};
  line_.push_back(&waiter);
  while (!waiter.has_turn && !is_cancelled) {
    waiter.wake.wait_for(lock, kLookAtFlag, [&] { return waiter.has_turn; });
  }
  if (waiter.has_turn) return Turn(*this, threads);
  std::erase(line_, &waiter);
  serve();
  return std::nullopt;
}

void PlanQueue::give_back(int threads) {
  const std::lock_guard lock(mutex_);
  free_ += threads;
  serve();
}

void PlanQueue::serve() {
  while (!line_.empty() && line_.front()->threads <= free_) {
    Waiter& waiter = *line_.front();
    line_.pop_front();
    free_ -= waiter.threads;
    // It cannot be gone before the lock is.
    waiter.has_turn = true;
    waiter.wake.notify_one();
  }
}

int PlanQueue::waiting() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(line_.size());
}

}  // namespace mneme::internal
