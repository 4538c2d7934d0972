// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "learning/run.h"

#include <utility>

namespace mneme::internal {
namespace {

/// Inserts in the order of the tasks, so that the database does not depend on the threads.
class LocalSource final : public TaskSource {
 public:
  LocalSource(Database& database, const std::vector<std::size_t>& tasks)
      : database_(database), tasks_(tasks), ready_(tasks) {}

  /// All of them, because nobody else wants them.
  Result<std::vector<std::size_t>> take(std::size_t) override { return std::exchange(ready_, {}); }

  Result<void> save(Results& results, LearnSummary& summary) override {
    std::vector<Experience> rows;
    auto end = results.begin();
    std::size_t saved = saved_;
    for (; end != results.end() && end->first == tasks_[saved]; ++end, ++saved) {
      rows.insert(rows.end(), end->second.rows.begin(), end->second.rows.end());
    }
    std::vector<bool> is_new;
    if (!rows.empty()) {
      const auto inserted = database_.insert(std::move(rows), &is_new);
      if (!inserted) return tl::unexpected(inserted.error());
    }
    auto first = is_new.cbegin();
    for (auto done = results.begin(); done != end; ++done) {
      count(done->second, first, summary);
      first += std::ssize(done->second.rows);
    }
    results.erase(results.begin(), end);
    saved_ = saved;
    return {};
  }

  Result<std::int64_t> count_open() override {
    return static_cast<std::int64_t>(tasks_.size() - saved_);
  }

 private:
  Database& database_;
  const std::vector<std::size_t>& tasks_;
  std::vector<std::size_t> ready_;
  std::size_t saved_ = 0;
};

}  // namespace

Result<LearnSummary> run_local(Database& database, const Tasks& tasks, const LearnRun& run) {
  LocalSource source(database, tasks.open);
  return run_tasks(source, tasks, run);
}

}  // namespace mneme::internal
