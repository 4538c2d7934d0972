// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/experience_cache.h"

#include <algorithm>

namespace mneme::internal {
namespace {

/// Whoever searches waits for no more than these at a time.
constexpr std::size_t kRowsAtOnce = 8;
/// Rows are seldom smaller: for so many the table need not grow, which would take milliseconds.
constexpr std::int64_t kUsualRow = 1024;
constexpr std::int64_t kMostPlaces = 1 << 18;

/// Of the allocator, the list and the table, per row.
constexpr std::size_t kOverhead = 160;

template <class Value>
std::size_t bytes_in(const std::vector<Value>& values) {
  return values.capacity() * sizeof(Value);
}

}  // namespace

std::int64_t bytes_of(const Experience& row) {
  const LocalSampler& sampler = row.sampler;
  const Provenance& provenance = row.provenance;
  return static_cast<std::int64_t>(
      sizeof row + kOverhead + row.kind.capacity() + bytes_in(row.key) + bytes_in(sampler.means) +
      bytes_in(sampler.factor_rows) + bytes_in(sampler.factors) + bytes_in(sampler.origins) +
      provenance.tool.capacity() + provenance.settings.capacity() + provenance.time.capacity());
}

ExperienceCache::ExperienceCache(std::int64_t capacity_bytes) : capacity_(capacity_bytes) {
  places_.reserve(static_cast<std::size_t>(
      std::clamp(capacity_bytes / kUsualRow, std::int64_t{0}, kMostPlaces)));
}

std::vector<SharedExperience> ExperienceCache::find(std::span<const std::int64_t> ids) {
  std::vector<SharedExperience> found(ids.size());
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const auto place = places_.find(ids[i]);
    if (place == places_.end()) continue;
    rows_.splice(rows_.begin(), rows_, place->second);
    found[i] = *place->second;
  }
  return found;
}

void ExperienceCache::keep(std::span<const SharedExperience> rows) {
  for (; !rows.empty(); rows = rows.subspan(std::min(kRowsAtOnce, rows.size()))) {
    keep_few(rows.first(std::min(kRowsAtOnce, rows.size())));
  }
}

void ExperienceCache::keep_few(std::span<const SharedExperience> rows) {
  Rows released;  // outlives the lock: nobody waits for their memory to be given back
  const std::lock_guard lock(mutex_);
  for (const SharedExperience& row : rows) {
    if (places_.contains(row->id)) continue;
    rows_.push_front(row);
    places_.emplace(row->id, rows_.begin());
    bytes_ += bytes_of(*row);
  }
  while (bytes_ > capacity_ && !rows_.empty()) {
    is_full_ = true;
    bytes_ -= bytes_of(*rows_.back());
    places_.erase(rows_.back()->id);
    released.splice(released.begin(), rows_, std::prev(rows_.end()));
  }
}

void ExperienceCache::forget(std::span<const std::int64_t> ids) {
  Rows released;
  const std::lock_guard lock(mutex_);
  for (const std::int64_t id : ids) {
    const auto place = places_.find(id);
    if (place == places_.end()) continue;
    bytes_ -= bytes_of(**place->second);
    released.splice(released.begin(), rows_, place->second);
    places_.erase(place);
  }
}

bool ExperienceCache::is_full() const {
  const std::lock_guard lock(mutex_);
  return is_full_;
}

}  // namespace mneme::internal
