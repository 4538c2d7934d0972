// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A queue for planning threads: a fixed number of threads, and a limited number of waiting
/// requests.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <list>
#include <mutex>
#include <optional>
#include <utility>

namespace mneme::internal {

/// The resources that a request waits for.
struct TurnRequest {
  int threads = 1;
  bool is_alone = false;  ///< at most one such request runs at a time
  /// Size of the body, which bounds the work of reading it.
  std::size_t bytes = 0;
};

/// Requests with small bodies overtake those with large ones: each waits as if it came later by
/// the time that its bytes take to read, so all have a turn. Small requests have one more thread of
/// their own, so that large ones cannot hold up all. Thread-safe.
class PlanQueue {
 public:
  /// Largest body of a small request.
  static constexpr std::size_t kSmallBytes = 8192;

  PlanQueue(int threads, int most_waiting) : free_(threads), most_waiting_(most_waiting) {}
  PlanQueue(const PlanQueue&) = delete;
  PlanQueue& operator=(const PlanQueue&) = delete;

  /// The right of a request to plan: holds threads until it is destroyed.
  class Turn {
   public:
    Turn(PlanQueue& queue, const TurnRequest& request, bool is_spare)
        : queue_(&queue), request_(request), is_spare_(is_spare) {}
    Turn(Turn&& other) noexcept
        : queue_(std::exchange(other.queue_, nullptr)),
          request_(other.request_),
          is_spare_(other.is_spare_) {}
    Turn& operator=(Turn&&) = delete;
    ~Turn() {
      if (queue_ != nullptr) queue_->give_back(request_, is_spare_);
    }

   private:
    PlanQueue* queue_;
    TurnRequest request_;
    bool is_spare_;  ///< runs on the thread for small requests
  };

  /// Waits until the threads of `request`, at most the total, are free, and holds them by the
  /// returned Turn. Other requests may overtake requests that wait to be alone. Returns nothing if
  /// the queue is full, or once `is_cancelled` is set.
  [[nodiscard]] std::optional<Turn> wait_for_turn(const std::atomic<bool>& is_cancelled,
                                                  const TurnRequest& request = {});
  [[nodiscard]] int waiting() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Waiter {
    TurnRequest request;
    Clock::time_point rank;  ///< when it came, later by the time to read its bytes
    std::condition_variable wake = {};
    bool has_turn = false, is_spare = false;
  };
  void insert(Waiter& waiter);
  void give_back(const TurnRequest& request, bool is_spare);
  /// Gives free threads to the first waiters. Call with mutex_ locked.
  void serve();

  mutable std::mutex mutex_;
  std::list<Waiter*> waiters_;  ///< by rank
  int free_;
  int most_waiting_;
  bool is_one_alone_ = false;
  bool is_spare_free_ = true;
};

}  // namespace mneme::internal
