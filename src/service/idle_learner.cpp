// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "service/idle_learner.h"

#include "base/threads.h"

#include <system_error>
#include <utility>

namespace mneme::internal {

void IdleLearner::offer(const Problem& problem, const SolveSettings& settings,
                        const PlanResult& plan) {
  if (!plan.is_solved() || plan.iterations + plan.states_checked < kLeastWork) return;
  const std::lock_guard lock(mutex_);
  if (is_stopping_) return;
  Lesson& lesson = lessons_.emplace_back(Lesson{problem, settings, 0});
  lesson.settings.plan.cancel = &is_interrupted_;
  lesson.settings.plan.observer = nullptr;
  if (lessons_.size() > kMostWaiting) lessons_.pop_front();
  if (thread_.joinable()) return changed_.notify_one();
  try {
    thread_ = std::thread([this] { run(); });
  } catch (const std::system_error&) {
    lessons_.clear();  // no thread is left; the next lesson tries again
  }
}

void IdleLearner::change(int requests) {
  const std::lock_guard lock(mutex_);
  requests_ += requests;
  if (requests > 0) ++interruptions_;
  is_interrupted_ = is_stopping_ || requests_ > 0;
  changed_.notify_one();
}

void IdleLearner::stop() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = is_interrupted_ = true;
  }
  changed_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void IdleLearner::run() {
  give_way();
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return is_stopping_ || (requests_ == 0 && !lessons_.empty()); });
    if (is_stopping_) return;
    Lesson lesson = std::move(lessons_.front());
    lessons_.pop_front();
    const std::uint64_t interruptions = interruptions_;
    lock.unlock();
    // A hint: what goes wrong is reported by the next plan.
    static_cast<void>(
        without_ending([&] { return study(lesson.problem, *database_, lesson.settings); }));
    lock.lock();
    if (is_stopping_) return;
    if (interruptions == interruptions_) {
      ++finished_;
    } else if (++lesson.tries < kMostTries && lessons_.size() < kMostWaiting) {
      lessons_.push_front(std::move(lesson));
    }
  }
}

}  // namespace mneme::internal
