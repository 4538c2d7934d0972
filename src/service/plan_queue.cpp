// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "service/plan_queue.h"

#include <algorithm>
#include <chrono>

namespace mneme::internal {
namespace {

constexpr std::chrono::milliseconds kLookAtFlag{10};

}  // namespace

std::optional<PlanQueue::Turn> PlanQueue::wait_for_turn(const std::atomic<bool>& is_cancelled) {
  std::unique_lock lock(mutex_);
  if (free_ > 0 && line_.empty()) {
    --free_;
    return Turn(*this);
  }
  if (static_cast<int>(line_.size()) >= longest_line_) return std::nullopt;
  Waiter waiter;
  line_.push_back(&waiter);
  while (!waiter.has_turn && !is_cancelled) {
    waiter.wake.wait_for(lock, kLookAtFlag, [&] { return waiter.has_turn; });
  }
  if (waiter.has_turn) return Turn(*this);
  std::erase(line_, &waiter);
  return std::nullopt;
}

void PlanQueue::give_back() {
  const std::lock_guard lock(mutex_);
  if (line_.empty()) {
    ++free_;
    return;
  }
  // Under the lock: the waiter may be gone as soon as it can be.
  line_.front()->has_turn = true;
  line_.front()->wake.notify_one();
  line_.pop_front();
}

int PlanQueue::waiting() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(line_.size());
}

}  // namespace mneme::internal
