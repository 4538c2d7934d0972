// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/write_queue.h"

#include "base/threads.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <system_error>
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

void WriteQueue::push(std::int64_t count, Make make) {
  std::unique_lock lock(mutex_);
  if (counts_.waiting + count > kMostRows) {
    return drop(
        count, fmt::format("more than {} rows wait to be stored; new ones are dropped", kMostRows));
  }
  if (!thread_.joinable()) {
    try {
      thread_ = std::thread([this] { run(); });
    } catch (const std::system_error& error) {
      return drop(count, fmt::format("no thread to store rows: {}", error.what()));
    }
  }
  lots_.push_back({count, std::move(make)});
  counts_.waiting += count;
  const bool is_idle = is_idle_;
  lock.unlock();                       // a thread that wakes takes the lock at once
  if (is_idle) changed_.notify_all();  // to wake a thread costs more than all the rest
}

void WriteQueue::drop(std::int64_t count, std::string failure) {
  counts_.lost += count;
  counts_.failure = std::move(failure);
}

bool WriteQueue::flush(double timeout_s) {
  std::unique_lock lock(mutex_);
  ++flushes_;
  changed_.notify_all();
  const bool is_done = changed_.wait_for(lock, std::chrono::duration<double>(timeout_s),
                                         [this] { return counts_.waiting == 0; });
  --flushes_;
  return is_done;
}

QueuedRows WriteQueue::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

void WriteQueue::run() {
  constexpr std::chrono::milliseconds kRetryAfter(500), kCollect(5);
  give_way();  // woken on the core of the thread that answers, it would delay that answer
  std::unique_lock lock(mutex_);
  for (;;) {
    is_idle_ = true;
    changed_.wait(lock, [this] { return is_stopping_ || counts_.waiting > 0; });
    is_idle_ = false;
    changed_.wait_for(lock, kCollect, [this] { return is_stopping_ || flushes_ > 0; });
    if (is_stopping_) return;
    make_some(lock);
    const bool is_done = insert_some(lock);
    if (!is_done) changed_.wait_for(lock, kRetryAfter, [this] { return is_stopping_; });
  }
}

void WriteQueue::make_some(std::unique_lock<std::mutex>& lock) {
  // While rows cannot be inserted, all are made: a lot may hold a scene, rows are small.
  const auto is_wanted = [this] { return rows_.size() < kRowsAtOnce || must_retry_; };
  while (!lots_.empty() && is_wanted() && !is_stopping_) {
    Lot lot = std::move(lots_.front());
    lots_.pop_front();
    // Rows are kept and lots freed without the lock: push() in a thread that answers waits for it
    // as long as this thread, of low priority, is not scheduled.
    lock.unlock();
    auto made = without_ending(lot.make);
    lot.make = nullptr;
    const std::int64_t count = made ? std::ssize(*made) : 0;
    if (made) std::ranges::move(*made, std::back_inserter(rows_));
    lock.lock();
    counts_.waiting += count - lot.count;
    if (!made) drop(lot.count, made.error().message);
  }
  changed_.notify_all();
}

bool WriteQueue::insert_some(std::unique_lock<std::mutex>& lock) {
  if (rows_.empty()) return true;
  const auto count = static_cast<std::ptrdiff_t>(std::min(kRowsAtOnce, rows_.size()));
  lock.unlock();
  Outcome outcome;
  const bool is_done = insert({rows_.begin(), rows_.begin() + count}, outcome);
  rows_.erase(rows_.begin(), rows_.begin() + outcome.done);
  lock.lock();
  counts_.failure = std::move(outcome.failure);
  must_retry_ = !is_done;
  counts_.waiting -= outcome.done;
  counts_.stored += outcome.stored;
  counts_.lost += outcome.lost;
  changed_.notify_all();
  return is_done;
}

bool WriteQueue::insert(std::span<const Experience> rows, Outcome& outcome) {
  const auto added = without_ending([&] { return insert_({rows.begin(), rows.end()}); });
  if (!added) outcome.failure = added.error().message;
  if (!added && added.error().code == ErrorCode::io) return false;
  // One row may be at fault.
  if (!added && added.error().code == ErrorCode::invalid && rows.size() > 1) {
    const std::size_t half = rows.size() / 2;
    return insert(rows.first(half), outcome) && insert(rows.subspan(half), outcome);
  }
  outcome.done += std::ssize(rows);
  (added ? outcome.stored : outcome.lost) += added ? *added : std::ssize(rows);
  return true;
}

}  // namespace mneme::internal
