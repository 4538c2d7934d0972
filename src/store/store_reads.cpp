// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/fail.h"
#include "store/store.h"

#include <fmt/format.h>

#include <algorithm>

namespace mneme::internal {

void Tally::add(const StoredRow& row) {
  ++found_.row_count;
  found_.row_digest ^= tally_mark(row.id, row.key_checksum);
  found_.last_row = std::max(found_.last_row, row.id);
  found_.generation = std::max(found_.generation, row.generation);
}

void Tally::add(const Tombstone& tombstone) {
  ++found_.tombstone_count;
  found_.tombstone_digest ^= tally_mark(tombstone.id, tombstone.checksum);
  found_.last_tombstone = std::max(found_.last_tombstone, tombstone.id);
  found_.generation = std::max(found_.generation, tombstone.generation);
}

std::optional<std::string> Tally::compare(const StoreState& head) const {
  if (found_.row_count != head.row_count) {
    return fmt::format("holds {} rows, but {} were inserted", found_.row_count, head.row_count);
  }
  if (found_.row_digest != head.row_digest) {
    return "the ids or checksums of its rows differ from the inserted ones";
  }
  if (found_.tombstone_count == head.tombstone_count &&
      found_.tombstone_digest == head.tombstone_digest) {
    return std::nullopt;
  }
  return fmt::format("its tombstones differ from the inserted ones: {} stored, {} inserted",
                     found_.tombstone_count, head.tombstone_count);
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
  Tally tally(begin);
  const auto add_dead = [&](const Tombstone& tombstone) {
    tally.add(tombstone);
    changes.dead.insert(tombstone.row);
    return Result<void>();
  };
  const auto add_row = [&](const StoredRow& row) {
    tally.add(row);
    return changes.dead.contains(row.id) ? Result<void>() : visit(row);
  };
  MNEME_TRY(transaction->read_tombstones(begin.last_tombstone, add_dead));
  MNEME_TRY(transaction->read_rows(begin.last_row, parts, add_row));
  if (const auto flaw = tally.compare(head)) {
    return fail(ErrorCode::corrupt, "{}: {}", store.name(), *flaw);
  }
  return changes;
}

}  // namespace mneme::internal
