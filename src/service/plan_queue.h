// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Who may plan now: so many at a time, so many more in line, and nobody else.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>

namespace mneme::internal {

/// First come, first served. All of it is safe from any thread.
class PlanQueue {
 public:
  PlanQueue(int threads, int longest_line) : free_(threads), longest_line_(longest_line) {}
  PlanQueue(const PlanQueue&) = delete;
  PlanQueue& operator=(const PlanQueue&) = delete;

  /// Some of the threads, until it is destroyed.
  class Turn {
   public:
    Turn(PlanQueue& queue, int threads) : queue_(&queue), threads_(threads) {}
    Turn(Turn&& other) noexcept : queue_(other.queue_), threads_(other.threads_) {
      other.queue_ = nullptr;
    }
    Turn& operator=(Turn&&) = delete;
    ~Turn() {
      if (queue_ != nullptr) queue_->give_back(threads_);
    }

   private:
    PlanQueue* queue_;
    int threads_;
  };

  /// Waits in line for so many threads, at most all there are. Nothing if the line is full, or once
  /// `is_cancelled`.
  [[nodiscard]] std::optional<Turn> wait_for_turn(const std::atomic<bool>& is_cancelled,
                                                  int threads = 1);
  [[nodiscard]] int waiting() const;

 private:
  struct Waiter {
    int threads = 1;
    std::condition_variable wake = {};
    bool has_turn = false;
  };
  void give_back(int threads);
  /// Gives turns to those who are first in line, as far as threads are free. Under the lock.
  void serve();

  mutable std::mutex mutex_;
  std::deque<Waiter*> line_;
  int free_;
  int longest_line_;
};

}  // namespace mneme::internal
