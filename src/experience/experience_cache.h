// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Rows in memory, up to a number of bytes.
#pragma once

#include "mneme/experience.h"

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

}  // namespace mneme::internal
