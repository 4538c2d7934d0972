// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Makes and inserts rows on a thread of its own.
#pragma once

#include "mneme/experience.h"

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

namespace mneme::internal {

/// Makes rows and inserts them in order, all that arrive within milliseconds in one transaction.
/// Rows that cannot be inserted for an error of code io are tried again. Rows that are refused for
/// another error are tried in halves, and those that are refused alone are lost, as are those that
/// cannot be made. Thread-safe.
class WriteQueue {
 public:
  /// Inserts rows and returns the number of new ones. Called by the queue's thread alone.
  using Insert = std::function<Result<std::int64_t>(const std::vector<Experience>& rows)>;
  /// Makes rows. Called by the queue's thread alone, once.
  using Make = std::function<Result<std::vector<Experience>>()>;
  explicit WriteQueue(Insert insert) : insert_(std::move(insert)) {}
  WriteQueue(const WriteQueue&) = delete;
  WriteQueue& operator=(const WriteQueue&) = delete;
  /// Does not wait for rows that are still queued: call flush() first.
  ~WriteQueue();

  /// Counts `count` rows, at least 1, as waiting until they are made. Cost: some microseconds; the
  /// first call starts the thread. Without a thread the rows are lost.
  void push(std::int64_t count, Make make);
  /// Waits until all rows are inserted or lost. False if that takes longer.
  [[nodiscard]] bool flush(double timeout_s);
  [[nodiscard]] QueuedRows counts() const;

 private:
  struct Lot {
    std::int64_t count;
    Make make;
  };

  /// What became of the first rows.
  struct Outcome {
    std::ptrdiff_t done = 0;  ///< stored, known before, or lost
    std::int64_t stored = 0, lost = 0;
    std::string failure = {};  ///< error of the last attempt that failed
  };

  void run();
  void drop(std::int64_t count, std::string failure);
  /// Makes rows of the first lots, with `lock` released meanwhile, until they fill a transaction.
  void make_some(std::unique_lock<std::mutex>& lock);
  /// Tries to insert the first rows, with `lock` released meanwhile. False if they must be tried
  /// again.
  bool insert_some(std::unique_lock<std::mutex>& lock);
  /// Inserts rows in their order. False from an error of code io on.
  bool insert(std::span<const Experience> rows, Outcome& outcome);

  static constexpr std::int64_t kMostRows = 100000;
  static constexpr std::size_t kRowsAtOnce = 500;

  Insert insert_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Lot> lots_;
  std::vector<Experience> rows_;  ///< made, of the queue's thread alone
  QueuedRows counts_;
  bool must_retry_ = false;  ///< the last rows could not be inserted
  bool is_stopping_ = false;
  bool is_idle_ = false;  ///< the thread waits for rows
  int flushes_ = 0;       ///< callers of flush() that wait
  std::thread thread_;    ///< started with the first rows
};

}  // namespace mneme::internal
