// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Loads rows by id, from a cache of limited size or from the store.
#pragma once

#include "mneme/experience.h"

#include "store/store.h"

#include <atomic>
#include <list>
#include <mutex>
#include <unordered_map>

namespace mneme::internal {

using SharedExperience = std::shared_ptr<const Experience>;

/// Cache of rows; drops the least recently used. Thread-safe.
class ExperienceCache {
 public:
  explicit ExperienceCache(std::int64_t capacity_bytes);

  /// One pointer per id; null if not cached.
  [[nodiscard]] std::vector<SharedExperience> find(std::span<const std::int64_t> ids);
  void keep(std::span<const SharedExperience> rows);
  void forget(std::span<const std::int64_t> ids);
  /// True if rows were dropped for lack of space.
  [[nodiscard]] bool is_full() const;

 private:
  /// Most recently used first.
  using Rows = std::list<SharedExperience>;

  void keep_few(std::span<const SharedExperience> rows);

  std::int64_t capacity_;
  mutable std::mutex mutex_;
  Rows rows_;
  std::unordered_map<std::int64_t, Rows::iterator> places_;
  std::int64_t bytes_ = 0;
  bool is_full_ = false;
};

/// Approximate size of a row in memory, bytes.
[[nodiscard]] std::int64_t bytes_of(const Experience& row);

/// `keep`: rows that are read from the store are cached. `pass`: they are not, as when one caller
/// passes over all rows.
enum class Caching { keep, pass };

/// Loads rows on a separate connection, so that readers do not wait for writers. Thread-safe.
class RowLoader {
 public:
  /// `url` must remain valid when the process changes its directory.
  RowLoader(std::string url, RobotSignature signature, std::int64_t capacity_bytes,
            const ServerPatience& patience = {});

  [[nodiscard]] ExperienceCache& cache() const { return cache_; }
  /// Rows known in `epoch` may be missing in a later one.
  void set_epoch(std::int64_t epoch) { epoch_ = epoch; }

  /// One pointer per id; null for rows that were set aside meanwhile. Errors: corrupt, naming the
  /// row; io.
  [[nodiscard]] Result<std::vector<SharedExperience>> load(std::span<const std::int64_t> ids,
                                                           Caching caching) const;

 private:
  struct Reading;
  Result<void> read(std::span<const std::int64_t> ids, Reading& reading) const;
  Result<void> check_absent(StoreTransaction& transaction, const Reading& reading,
                            std::span<const std::int64_t> ids) const;

  std::string url_;
  RobotSignature signature_;
  ServerPatience patience_;
  mutable ExperienceCache cache_;
  std::atomic<std::int64_t> epoch_ = 0;
  mutable std::mutex mutex_;
  mutable std::unique_ptr<Store> store_;  // opened when it is first needed
};

}  // namespace mneme::internal
