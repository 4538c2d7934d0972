// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "learning/run.h"
#include "engines/open_store.h"

#include <unistd.h>
#include <array>
#include <utility>

namespace mneme::internal {
namespace {

/// Leases tasks from a database server.
class SharedSource final : public TaskSource {
 public:
  SharedSource(std::unique_ptr<TaskQueue> queue, Database& database, double lease_s)
      : queue_(std::move(queue)), database_(database), lease_s_(lease_s) {}

  Result<std::vector<std::size_t>> take(std::size_t count) override {
    return queue_->take(static_cast<int>(count), lease_s_).map([&](const auto& leases) {
      if (held_.empty()) since_renewal_ = Stopwatch();
      std::vector<std::size_t> tasks;
      for (const Lease& lease : leases) {
        tasks.push_back(static_cast<std::size_t>(lease.task));
        held_[tasks.back()] = lease;
      }
      return tasks;
    });
  }

  /// Lost leases are kept: after a commit without an answer, saving again needs the lease.
  Result<void> renew() override {
    if (held_.empty() || since_renewal_.elapsed_s() < lease_s_ / 3) return {};
    return queue_->renew(leases(), lease_s_).map([&](const auto&) {
      since_renewal_ = Stopwatch();
    });
  }

  Result<void> save(Results& results, LearnSummary& summary) override {
    std::vector<Lease> leases;
    std::vector<Experience> rows;
    for (const auto& [task, learned] : results) {
      if (!held_.contains(task)) continue;  // learned twice, because its lease was lost
      leases.push_back(held_.at(task));
      rows.push_back(learned.rows.at(0));
    }
    const auto good = MNEME_TRY(queue_->finish(leases, std::move(rows)));
    const std::vector<bool> is_new = {true};  // each task has one row, inserted only here
    for (const Lease& lease : good) {
      count(results.at(static_cast<std::size_t>(lease.task)), is_new.cbegin(), summary);
    }
    for (const auto& [task, learned] : std::exchange(results, {})) held_.erase(task);
    return {};
  }

  Result<std::int64_t> count_open() override { return queue_->count_open(); }

  /// On failure the leases expire.
  void release() override {
    if (!held_.empty()) (void)queue_->release(leases());
  }

  Result<void> refresh() override {
    return database_.refresh().map([](std::int64_t) {});
  }

  [[nodiscard]] double patience_s() const override { return lease_s_; }

 private:
  [[nodiscard]] std::vector<Lease> leases() const {
    std::vector<Lease> leases;
    for (const auto& [task, lease] : held_) leases.push_back(lease);
    return leases;
  }

  std::unique_ptr<TaskQueue> queue_;
  Database& database_;
  double lease_s_;
  std::map<std::size_t, Lease> held_;  ///< leases of unsaved tasks
  Stopwatch since_renewal_;
};

std::string worker_name() {
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  return std::string(host.data()) + ":" + std::to_string(::getpid());
}

}  // namespace

Result<LearnSummary> run_shared(Database& database, const Tasks& tasks, const SharedWork& work,
                                std::int64_t job, std::int64_t generation, const LearnRun& run) {
  if (!(work.lease_s >= 0.1 && work.lease_s <= 86400)) {
    return fail(ErrorCode::invalid, "a lease must last 0.1 to 86400 seconds");
  }
  auto queue = MNEME_TRY(open_tasks(work.url, database.signature(), {job, worker_name()}));
  const std::vector<std::int64_t> numbers(tasks.open.begin(), tasks.open.end());
  MNEME_TRY(queue->add(numbers, generation));
  SharedSource source(std::move(queue), database, work.lease_s);
  return run_tasks(source, tasks, run);
}

}  // namespace mneme::internal
