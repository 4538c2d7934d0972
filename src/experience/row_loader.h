// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Rows by their ids: from memory, up to a number of bytes, or else from where they are stored.
#pragma once

#include "mneme/experience.h"

#include "experience/row_loader.h"
#include "store/store.h"

#include <atomic>
#include <list>
#include <mutex>
#include <unordered_map>

namespace mneme::internal {

using SharedExperience = std::shared_ptr<const Experience>;

/// Lets go of the rows that were not asked for the longest time. Thread-safe.
class ExperienceCache {
 public:
  explicit ExperienceCache(std::int64_t capacity_bytes);

  /// One per id; empty where it is not here.
  [[nodiscard]] std::vector<SharedExperience> find(std::span<const std::int64_t> ids);
  void keep(std::span<const SharedExperience> rows);
  void forget(std::span<const std::int64_t> ids);
  /// It has let rows go that others may still ask for.
  [[nodiscard]] bool is_full() const;

 private:
  /// The row that was asked for last comes first.
  using Rows = std::list<SharedExperience>;

  void keep_few(std::span<const SharedExperience> rows);

  std::int64_t capacity_;
  mutable std::mutex mutex_;
  Rows rows_;
  std::unordered_map<std::int64_t, Rows::iterator> places_;
  std::int64_t bytes_ = 0;
  bool is_full_ = false;
};

/// What a row takes in memory, about.
[[nodiscard]] std::int64_t bytes_of(const Experience& row);

/// Has a connection of its own, so that whoever reads does not wait for whoever writes.
/// Thread-safe.
class RowLoader {
 public:
  /// `url` has to stay right when the process changes its directory.
  RowLoader(std::string url, RobotSignature signature, std::int64_t capacity_bytes);

  [[nodiscard]] ExperienceCache& cache() const { return cache_; }
  /// Rows whose ids were known in `epoch` may have been removed in a later one.
  void set_epoch(std::int64_t epoch) { epoch_ = epoch; }

  /// One per id; empty for those that were set aside in the meantime. What had to be read stays in
  /// memory if `is_kept`. Errors: corrupt, naming the row; io.
  [[nodiscard]] Result<std::vector<SharedExperience>> load(std::span<const std::int64_t> ids,
                                                           bool is_kept) const;

 private:
  struct Reading;
  Result<void> read(std::span<const std::int64_t> ids, Reading& reading) const;
  Result<void> check_absent(StoreTransaction& transaction, const Reading& reading,
                            std::span<const std::int64_t> ids) const;

  std::string url_;
  RobotSignature signature_;
  mutable ExperienceCache cache_;
  std::atomic<std::int64_t> epoch_ = 0;
  mutable std::mutex mutex_;
  mutable std::unique_ptr<Store> store_;  // opened when it is first needed
};

}  // namespace mneme::internal
