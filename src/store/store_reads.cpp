// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/fail.h"
#include "store/store.h"

#include <fmt/format.h>

#include <algorithm>

namespace mneme::internal {

void count(const StoredRow& row, StoreState& state) {
  ++state.row_count;
  state.row_digest ^= tally_mark(row.id, row.key_checksum);
  state.last_row = std::max(state.last_row, row.id);
  state.generation = std::max(state.generation, row.generation);
}

void count(const Tombstone& tombstone, StoreState& state) {
  ++state.tombstone_count;
  state.tombstone_digest ^= tally_mark(tombstone.id, tombstone.checksum);
  state.last_tombstone = std::max(state.last_tombstone, tombstone.id);
  state.generation = std::max(state.generation, tombstone.generation);
}

std::optional<std::string> describe_difference(const StoreState& counted, const StoreState& head) {
  if (counted.row_count != head.row_count) {
    return fmt::format("holds {} rows, but {} were inserted", counted.row_count, head.row_count);
  }
  if (counted.row_digest != head.row_digest) {
    return "the ids or checksums of its rows differ from the inserted ones";
  }
  if (counted.tombstone_count == head.tombstone_count &&
      counted.tombstone_digest == head.tombstone_digest) {
    return std::nullopt;
  }
  return fmt::format("its tombstones differ from the inserted ones: {} stored, {} inserted",
                     counted.tombstone_count, head.tombstone_count);
}

Result<StoreChanges> read_changes(Store& store, const StoreState& since, RowParts parts,
                                  const RowVisitor& visit) {
  const auto transaction = MNEME_TRY(store.begin(Store::Kind::read));
  const auto head = MNEME_TRY(transaction->head());
  StoreChanges changes;
  changes.state = head;
  if (head == since) return changes;
  changes.is_complete = head.epoch != since.epoch || head.row_count < since.row_count;
  const StoreState begin = changes.is_complete ? StoreState{} : since;
  StoreState counted = begin;
  const auto add_dead = [&](const Tombstone& tombstone) {
    count(tombstone, counted);
    changes.dead.insert(tombstone.row);
    return Result<void>();
  };
  const auto add_row = [&](const StoredRow& row) {
    count(row, counted);
    return changes.dead.contains(row.id) ? Result<void>() : visit(row);
  };
  MNEME_TRY(transaction->read_tombstones(begin.last_tombstone, add_dead));
  MNEME_TRY(transaction->read_rows(begin.last_row, parts, add_row));
  if (const auto flaw = describe_difference(counted, head)) {
    return fail(ErrorCode::corrupt, "{}: {}", store.name(), *flaw);
  }
  return changes;
}

}  // namespace mneme::internal
