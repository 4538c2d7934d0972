// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Learning in time that no request needs.
#pragma once

#include "mneme/pipeline.h"

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>

namespace mneme::internal {

/// Studies the problems that took longest, on a thread of its own, while no request is at work. A
/// request ends a study at once; it begins again later. Thread-safe.
class IdleLearner {
 public:
  explicit IdleLearner(std::shared_ptr<Database> database) : database_(std::move(database)) {}
  IdleLearner(const IdleLearner&) = delete;
  IdleLearner& operator=(const IdleLearner&) = delete;
  ~IdleLearner() { stop(); }

  /// Queues a solved problem if its search was long. The last kMostWaiting are kept.
  void offer(const Problem& problem, const SolveSettings& settings, const PlanResult& plan);
  /// Ends a study within some milliseconds; none begins from now on.
  void stop();
  [[nodiscard]] std::uint64_t finished() const { return finished_; }

  /// A request at work.
  class Request {
   public:
    /// `learner` may be null.
    explicit Request(IdleLearner* learner) : learner_(learner) {
      if (learner_ != nullptr) learner_->change(1);
    }
    Request(const Request&) = delete;
    Request& operator=(const Request&) = delete;
    ~Request() {
      if (learner_ != nullptr) learner_->change(-1);
    }

   private:
    IdleLearner* learner_;
  };

 private:
  static constexpr std::size_t kMostWaiting = 16;
  /// Iterations and checked states of a search that is worth a study: 20 to 100 ms.
  static constexpr std::uint64_t kLeastWork = 50'000;

  /// A study that requests end this often is given up.
  static constexpr int kMostTries = 3;

  struct Lesson {
    Problem problem;
    SolveSettings settings;
    int tries = 0;
  };

  void change(int requests);
  void run();

  std::shared_ptr<Database> database_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Lesson> lessons_;
  int requests_ = 0;
  std::uint64_t interruptions_ = 0;
  bool is_stopping_ = false;
  std::atomic<bool> is_interrupted_ = false;
  std::atomic<std::uint64_t> finished_ = 0;
  std::thread thread_;  ///< started with the first lesson
};

}  // namespace mneme::internal
