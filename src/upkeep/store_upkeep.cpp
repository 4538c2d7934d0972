// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "upkeep/store_upkeep.h"

#include "base/fail.h"
#include "store/row_check.h"
#include "store/store.h"

#include <algorithm>
#include <map>
#include <tuple>

namespace mneme::internal {
namespace {

tl::unexpected<Error> damaged(const Store& store, std::int64_t id, const std::string& flaw) {
  return fail(ErrorCode::corrupt, "{}: row {} is damaged: {}", store.name(), id, flaw);
}

}  // namespace

Result<std::vector<LiveRow>> list_by_content(Store& store) {
  std::vector<LiveRow> list;
  KeySizes sizes;
  const auto visit = [&](const StoredRow& row) -> Result<void> {
    Experience key;
    auto flaw = decode_key(row, key);
    if (!flaw) flaw = sizes.check(key.kind, key.key.size());
    if (flaw) return damaged(store, row.id, *flaw);
    list.push_back({to_content_hash(row.content), row.id});
    return {};
  };
  MNEME_TRY(read_changes(store, {}, RowParts::keys, visit));
  std::sort(list.begin(), list.end(), [](const LiveRow& a, const LiveRow& b) {
    return std::tie(a.content, a.id) < std::tie(b.content, b.id);
  });
  return list;
}

Result<void> visit_rows(Store& store, const RobotSignature& signature,
                        std::span<const LiveRow> list, const RowsVisitor& visit) {
  constexpr std::size_t kRowsAtOnce = 500;
  while (!list.empty()) {
    const auto part = list.first(std::min(kRowsAtOnce, list.size()));
    list = list.subspan(part.size());
    std::map<std::int64_t, std::size_t> places;
    std::vector<std::int64_t> ids;
    for (const LiveRow& row : part) {
      places.emplace(row.id, ids.size());
      ids.push_back(row.id);
    }
    const auto transaction = MNEME_TRY(store.begin(Store::Kind::read));
    std::vector<Experience> rows(part.size());
    const auto fill = [&](const StoredRow& row) -> Result<void> {
      Experience& experience = rows[places.at(row.id)];
      if (auto flaw = decode(row, signature, experience)) return damaged(store, row.id, *flaw);
      return {};
    };
    MNEME_TRY(transaction->read_rows_by_id(ids, fill));
    for (std::size_t i = 0; i < ids.size(); ++i) {
      if (rows[i].id == 0) return damaged(store, ids[i], "it vanished while it was read");
    }
    MNEME_TRY(visit(rows));
  }
  return {};
}

namespace {

/// Recounts rows and tombstones; keeps counters of the old head if it is readable.
Result<StoreState> recount(StoreTransaction& transaction) {
  const auto head = transaction.head();
  if (!head && head.error().code != ErrorCode::corrupt) return tl::unexpected(head.error());
  StoreState state;
  const auto visit = [&](const auto& counted) {
    count(counted, state);
    return Result<void>();
  };
  MNEME_TRY(transaction.read_tombstones(0, visit));
  MNEME_TRY(transaction.read_rows(0, RowParts::keys, visit));
  state.epoch = next_epoch(head ? &*head : nullptr);
  if (head) {
    state.generation = head->generation;
    state.last_row = std::max(state.last_row, head->last_row);
    state.last_tombstone = std::max(state.last_tombstone, head->last_tombstone);
  }
  ++state.generation;
  return state;
}

}  // namespace

Result<void> quarantine_rows(Store& store, std::span<const Damage> damages,
                             std::span<const std::int64_t> damaged_tombstones) {
  const auto transaction = MNEME_TRY(store.begin(Store::Kind::write));
  MNEME_TRY(transaction->remove_tombstones(damaged_tombstones));
  auto state = MNEME_TRY(recount(*transaction));
  std::vector<Tombstone> tombstones;
  for (const Damage& damage : damages) {
    if (damage.id == 0) continue;
    tombstones.push_back(make_tombstone(state, damage.id, "damaged: " + damage.what));
  }
  return transaction->add_tombstones(tombstones)
      .and_then([&] { return transaction->set_head(state); })
      .and_then([&] { return transaction->commit(); });
}

Result<std::int64_t> compact_store(Store& store) {
  std::int64_t removed = 0;
  {
    const auto transaction = MNEME_TRY(store.begin(Store::Kind::write));
    const auto head = MNEME_TRY(transaction->head());
    if (head.tombstone_count > 0) {
      MNEME_TRY(transaction->remove_dead());
      const auto state = MNEME_TRY(recount(*transaction));
      removed = head.row_count - state.row_count;
      MNEME_TRY(transaction->set_head(state));
      MNEME_TRY(transaction->commit());
    }
  }
  MNEME_TRY(store.reclaim());
  return removed;
}

Result<void> merge_rows(Store& target, std::span<const Experience> rows, MergeSummary& summary) {
  return append_rows(target, rows, Duplicates::keep_earliest).map([&](const Appended& appended) {
    const auto added = std::ranges::count(appended.is_new, true);
    summary.read += static_cast<std::int64_t>(rows.size());
    summary.replaced += appended.replaced_count;
    summary.added += added - appended.replaced_count;
  });
}

Result<void> merge_lessons(Store& target, Store& source) {
  const auto reading = MNEME_TRY(source.begin(Store::Kind::read));
  const auto marks = MNEME_TRY(reading->read_lessons());
  if (marks.empty()) return {};
  const auto writing = MNEME_TRY(target.begin(Store::Kind::write));
  MNEME_TRY(writing->add_lessons(marks));
  return writing->commit();
}

}  // namespace mneme::internal
