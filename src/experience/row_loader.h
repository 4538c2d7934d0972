// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Rows by their ids: from memory, or else from where they are stored.
#pragma once

#include "experience/experience_cache.h"
#include "experience/store.h"

#include <atomic>

namespace mneme::internal {

/// Has a connection of its own, so that whoever reads does not wait for whoever writes.
/// Thread-safe.
class RowLoader {
 public:
  RowLoader(const std::string& url, ExperienceSpace space, std::int64_t capacity_bytes);

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
  ExperienceSpace space_;
  mutable ExperienceCache cache_;
  std::atomic<std::int64_t> epoch_ = 0;
  mutable std::mutex mutex_;
  mutable std::unique_ptr<Store> store_;  // opened when it is first needed
};

}  // namespace mneme::internal
