// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/row_loader.h"

#include "base/fail.h"
#include "engines/open_store.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace mneme::internal {
namespace {

/// Rows cached under one lock, so that searches wait only briefly.
constexpr std::size_t kRowsAtOnce = 8;
/// Typical row size. The table is reserved for this many rows, because growing takes milliseconds.
constexpr std::int64_t kUsualRow = 1024;
constexpr std::int64_t kMostPlaces = 1 << 18;

/// Overhead of allocator, list and table per row.
constexpr std::size_t kOverhead = 160;

template <class Value>
std::size_t bytes_in(const std::vector<Value>& values) {
  return values.capacity() * sizeof(Value);
}

}  // namespace

std::int64_t bytes_of(const Experience& row) {
  std::size_t content = 0;
  if (row.is_path()) {
    const RememberedPath& path = row.path();
    content = bytes_in(path.waypoints) + bytes_in(path.clearances) + bytes_in(path.near_misses);
  } else {
    const LocalSampler& sampler = row.sampler();
    content = bytes_in(sampler.means) + bytes_in(sampler.factor_rows) + bytes_in(sampler.factors) +
              bytes_in(sampler.sources);
  }
  const Provenance& provenance = row.provenance;
  return static_cast<std::int64_t>(sizeof row + kOverhead + row.kind.capacity() +
                                   bytes_in(row.key) + content + provenance.tool.capacity() +
                                   provenance.settings.capacity() + provenance.time.capacity());
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
  Rows released;  // freed after the lock is released
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

struct RowLoader::Reading {
  std::map<std::int64_t, SharedExperience> rows;
  std::map<std::int64_t, std::string> flaws;
};

RowLoader::RowLoader(std::string url, RobotSignature signature, std::int64_t capacity_bytes,
                     const ServerPatience& patience)
    : url_(std::move(url)),
      signature_(std::move(signature)),
      patience_(patience),
      cache_(capacity_bytes) {}

Result<std::vector<SharedExperience>> RowLoader::load(std::span<const std::int64_t> ids,
                                                      Caching caching) const {
  std::vector<SharedExperience> found = cache_.find(ids);
  std::vector<std::int64_t> missing;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (found[i] == nullptr) missing.push_back(ids[i]);
  }
  if (missing.empty()) return found;
  Reading reading;
  if (const auto done = read(missing, reading); !done) {
    return tl::unexpected(with_advice(done.error(), url_));
  }
  std::vector<SharedExperience> fresh;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const auto row = reading.rows.find(ids[i]);
    if (row == reading.rows.end()) continue;
    found[i] = row->second;
    fresh.push_back(row->second);
  }
  if (caching == Caching::keep) cache_.keep(fresh);
  return found;
}

Result<void> RowLoader::read(std::span<const std::int64_t> ids, Reading& reading) const {
  const std::lock_guard lock(mutex_);
  if (store_ == nullptr) {
    store_ = MNEME_TRY(open_store(url_, OpenMode::read_only, {LossCheck::refuse, patience_}));
  }
  const auto transaction = MNEME_TRY(store_->begin(Store::Kind::read));
  const auto visit = [&](const StoredRow& row) -> Result<void> {
    auto experience = std::make_shared<Experience>();
    if (const auto flaw = decode(row, signature_, *experience)) {
      reading.flaws.emplace(row.id, *flaw);
    } else {
      reading.rows.emplace(row.id, std::move(experience));
    }
    return {};
  };
  return transaction->read_rows_by_id(ids, visit).and_then([&] {
    return reading.rows.size() == ids.size() ? Result<void>()
                                             : check_absent(*transaction, reading, ids);
  });
}

/// Another process may have set rows aside or deleted them since their ids were read.
Result<void> RowLoader::check_absent(StoreTransaction& transaction, const Reading& reading,
                                     std::span<const std::int64_t> ids) const {
  std::set<std::int64_t> dead;
  const auto head = MNEME_TRY(transaction.head());
  const auto read = transaction.read_tombstones(0, [&](const Tombstone& tombstone) {
    dead.insert(tombstone.row);
    return Result<void>();
  });
  if (!read) return read;
  for (const std::int64_t id : ids) {
    if (reading.rows.contains(id) || dead.contains(id)) continue;
    const auto flaw = reading.flaws.find(id);
    if (flaw == reading.flaws.end() && head.epoch != epoch_) continue;
    return fail(ErrorCode::corrupt, "{}: row {} is damaged: {}", store_->name(), id,
                flaw == reading.flaws.end() ? "it is missing" : flaw->second);
  }
  return {};
}

}  // namespace mneme::internal
