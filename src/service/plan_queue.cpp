// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "service/plan_queue.h"

#include <iterator>

namespace mneme::internal {
namespace {

constexpr std::chrono::milliseconds kPollFlag{10};
/// Bytes of a body that are read, and turned into a scene, per microsecond.
constexpr std::size_t kBytesPerMicrosecond = 10;

bool is_small(const TurnRequest& request) {
  return request.threads == 1 && request.bytes <= PlanQueue::kSmallBytes;
}

}  // namespace

std::optional<PlanQueue::Turn> PlanQueue::wait_for_turn(const std::atomic<bool>& is_cancelled,
                                                        const TurnRequest& request) {
  std::unique_lock lock(mutex_);
  const std::chrono::microseconds reading(request.bytes / kBytesPerMicrosecond);
  Waiter waiter{request, Clock::now() + reading};
  insert(waiter);
  serve();
  const bool is_full = !waiter.has_turn && static_cast<int>(waiters_.size()) > most_waiting_;
  while (!waiter.has_turn && !is_cancelled && !is_full) {
    waiter.wake.wait_for(lock, kPollFlag, [&] { return waiter.has_turn; });
  }
  if (waiter.has_turn) return Turn(*this, request, waiter.is_spare);
  std::erase(waiters_, &waiter);
  serve();
  return std::nullopt;
}

/// Inserts behind all waiters of the same or an earlier rank.
void PlanQueue::insert(Waiter& waiter) {
  auto behind = waiters_.end();
  while (behind != waiters_.begin() && (*std::prev(behind))->rank > waiter.rank) --behind;
  waiters_.insert(behind, &waiter);
}

void PlanQueue::give_back(const TurnRequest& request, bool is_spare) {
  const std::lock_guard lock(mutex_);
  if (is_spare) {
    is_spare_free_ = true;
  } else {
    free_ += request.threads;
  }
  if (request.is_alone) is_one_alone_ = false;
  serve();
}

void PlanQueue::serve() {
  bool is_held_up = false;  // by a waiter that needs more threads than are free
  for (auto next = waiters_.begin(); next != waiters_.end();) {
    Waiter& waiter = **next;
    const TurnRequest& request = waiter.request;
    const bool must_wait = request.is_alone && is_one_alone_;
    const bool has_threads = !must_wait && !is_held_up && request.threads <= free_;
    if (!must_wait && !has_threads) is_held_up = true;
    waiter.is_spare = !must_wait && !has_threads && is_spare_free_ && is_small(request);
    if (!has_threads && !waiter.is_spare) {
      ++next;
      continue;
    }
    next = waiters_.erase(next);
    if (waiter.is_spare) {
      is_spare_free_ = false;
    } else {
      free_ -= request.threads;
    }
    is_one_alone_ = is_one_alone_ || request.is_alone;
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
