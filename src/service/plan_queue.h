// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A queue for planning threads: a fixed number of threads, and a limited number of waiting
/// requests.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

namespace mneme::internal {

/// First come, first served. Thread-safe.
class PlanQueue {
 public:
  PlanQueue(int threads, int most_waiting) : free_(threads), most_waiting_(most_waiting) {}
  PlanQueue(const PlanQueue&) = delete;
  PlanQueue& operator=(const PlanQueue&) = delete;

  /// The right of a request to plan: holds threads until it is destroyed.
  class Turn {
   public:
    Turn(PlanQueue& queue, int threads, bool is_alone)
        : queue_(&queue), threads_(threads), is_alone_(is_alone) {}
    Turn(Turn&& other) noexcept
        : queue_(std::exchange(other.queue_, nullptr)),
          threads_(other.threads_),
          is_alone_(other.is_alone_) {}
    Turn& operator=(Turn&&) = delete;
    ~Turn() {
      if (queue_ != nullptr) queue_->give_back(threads_, is_alone_);
    }

   private:
    PlanQueue* queue_;
    int threads_;
    bool is_alone_;
  };

  /// Waits until `threads` threads, at most the total, are free, and holds them by the returned
  /// Turn. At most one Turn with `is_alone` exists at a time; other requests may overtake requests
  /// that wait for it. Returns nothing if the queue is full, or once `is_cancelled` is set.
  [[nodiscard]] std::optional<Turn> wait_for_turn(const std::atomic<bool>& is_cancelled,
                                                  int threads = 1, bool is_alone = false);
  [[nodiscard]] int waiting() const;

 private:
  struct Waiter {
    int threads = 1;
    bool is_alone = false;
    std::condition_variable wake = {};
    bool has_turn = false;
  };
  void give_back(int threads, bool is_alone);
  /// Gives free threads to the first waiters. Call with mutex_ locked.
  void serve();

  mutable std::mutex mutex_;
  std::deque<Waiter*> waiters_;
  int free_;
  int most_waiting_;
  bool is_one_alone_ = false;
};

}  // namespace mneme::internal
