// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Who may plan now: so many at a time, so many more in line, and nobody else.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

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

  /// Waits in line for so many threads, at most all there are. Of those with `is_alone` one runs at
  /// a time; while it does, the others of them are overtaken. Nothing if the line is full, or once
  /// `is_cancelled`.
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
  /// Gives turns to those who are first in line, as far as threads are free. Under the lock.
  void serve();

  mutable std::mutex mutex_;
  std::deque<Waiter*> line_;
  int free_;
  int longest_line_;
  bool is_one_alone_ = false;
};

}  // namespace mneme::internal
