// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/write_queue.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <utility>

namespace mneme::internal {

WriteQueue::~WriteQueue() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void WriteQueue::push(std::vector<Experience> rows) {
  const std::lock_guard lock(mutex_);
  const std::size_t room = kMostRows - std::min(kMostRows, rows_.size());
  if (rows.size() > room) {
    counts_.lost += static_cast<std::int64_t>(rows.size() - room);
    counts_.failure =
        fmt::format("more than {} rows wait to be stored; new ones are dropped", kMostRows);
    rows.resize(room);
  }
  counts_.waiting += static_cast<std::int64_t>(rows.size());
  std::ranges::move(rows, std::back_inserter(rows_));
  if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
  changed_.notify_all();
}

bool WriteQueue::flush(double timeout_s) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, std::chrono::duration<double>(timeout_s),
                           [this] { return rows_.empty(); });
}

QueuedRows WriteQueue::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

void WriteQueue::run() {
  constexpr std::chrono::milliseconds kRetryAfter(500);
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return is_stopping_ || !rows_.empty(); });
    if (is_stopping_) return;
    const bool is_done = insert_some(lock);
    if (!is_done) changed_.wait_for(lock, kRetryAfter, [this] { return is_stopping_; });
  }
}

bool WriteQueue::insert_some(std::unique_lock<std::mutex>& lock) {
  const auto count = static_cast<std::ptrdiff_t>(std::min(kRowsAtOnce, rows_.size()));
  const std::vector<Experience> batch(rows_.begin(), rows_.begin() + count);
  lock.unlock();
  const auto added = insert_(batch);
  lock.lock();
  counts_.failure = added ? "" : added.error().message;
  if (!added && added.error().code == ErrorCode::io) return false;
  rows_.erase(rows_.begin(), rows_.begin() + count);
  counts_.waiting -= count;
  (added ? counts_.stored : counts_.lost) += added ? *added : count;
  changed_.notify_all();
  return true;
}

}  // namespace mneme::internal
