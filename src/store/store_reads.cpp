// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "store/store_reads.h"

#include "store/row_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace mneme::internal {
namespace {

tl::unexpected<Error> damaged(const Store& store, std::int64_t id, const std::string& flaw) {
  return fail(ErrorCode::corrupt, fmt::format("{}: row {} is damaged: {}", store.name(), id, flaw));
}

}  // namespace

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
    return "the ids or checksums of its rows are not those that were inserted";
  }
  if (found_.tombstone_count == head.tombstone_count &&
      found_.tombstone_digest == head.tombstone_digest) {
    return std::nullopt;
  }
  return fmt::format("holds {} tombstones, but {} others were inserted", found_.tombstone_count,
                     head.tombstone_count);
}

Result<StoreChanges> read_changes(Store& store, const StoreState& since, RowParts parts,
                                  const RowVisitor& visit) {
  const auto transaction = store.begin(Store::Kind::read);
  if (!transaction) return tl::unexpected(transaction.error());
  const auto head = (*transaction)->head();
  if (!head) return tl::unexpected(head.error());
  StoreChanges changes;
  changes.state = *head;
  if (*head == since) return changes;
  changes.is_complete = head->epoch != since.epoch || head->row_count < since.row_count;
  const StoreState begin = changes.is_complete ? StoreState{} : since;
  Tally tally(begin);
  const auto buried =
      (*transaction)->read_tombstones(begin.last_tombstone, [&](const Tombstone& tombstone) {
        tally.add(tombstone);
        changes.buried.insert(tombstone.row);
        return Result<void>();
      });
  if (!buried) return tl::unexpected(buried.error());
  const auto read =
      (*transaction)->read_rows(begin.last_row, parts, [&](const StoredRow& row) -> Result<void> {
        tally.add(row);
        return changes.buried.contains(row.id) ? Result<void>() : visit(row);
      });
  if (!read) return tl::unexpected(read.error());
  if (const auto flaw = tally.compare(*head)) {
    return fail(ErrorCode::corrupt, fmt::format("{}: {}", store.name(), *flaw));
  }
  return changes;
}

Result<std::vector<LiveRow>> list_by_content(Store& store) {
  std::vector<LiveRow> list;
  KeySizes sizes;
  const auto visit = [&](const StoredRow& row) -> Result<void> {
    Experience key;
    auto flaw = decode_key(row, key);
    if (!flaw) flaw = sizes.check(key.kind, key.key.size());
    if (flaw) return damaged(store, row.id, *flaw);
    LiveRow& live = list.emplace_back();
    live.id = row.id;
    std::copy_n(row.content.begin(), std::min(row.content.size(), live.content.size()),
                live.content.begin());
    return {};
  };
  const auto read = read_changes(store, {}, RowParts::keys, visit);
  if (!read) return tl::unexpected(read.error());
  std::sort(list.begin(), list.end(), [](const LiveRow& a, const LiveRow& b) {
    return std::tie(a.content, a.id) < std::tie(b.content, b.id);
  });
  return list;
}

Result<void> visit_rows(Store& store, const ExperienceSpace& space, std::span<const LiveRow> list,
                        const RowsVisitor& visit) {
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
    const auto transaction = store.begin(Store::Kind::read);
    if (!transaction) return tl::unexpected(transaction.error());
    std::vector<Experience> rows(part.size());
    const auto fill = [&](const StoredRow& row) -> Result<void> {
      Experience& experience = rows[places.at(row.id)];
      if (const auto flaw = decode(row, space, experience)) return damaged(store, row.id, *flaw);
      return {};
    };
    const auto read = (*transaction)->read_rows_by_id(ids, fill);
    if (!read) return read;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      if (rows[i].id == 0) return damaged(store, ids[i], "it vanished while it was read");
    }
    const auto visited = visit(rows);
    if (!visited) return visited;
  }
  return {};
}

}  // namespace mneme::internal
