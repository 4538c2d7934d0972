// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "store/store_writes.h"

#include "store/row_check.h"
#include "store/store_reads.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <tuple>

namespace mneme::internal {
namespace {

Tombstone make_tombstone(StoreState& state, std::int64_t row, std::string reason) {
  Tombstone tombstone{++state.last_tombstone, row, state.generation, std::move(reason),
                      current_time(),         0};
  tombstone.checksum = checksum_of(tombstone);
  ++state.tombstone_count;
  state.tombstone_digest ^= tally_mark(tombstone.id, tombstone.checksum);
  return tombstone;
}

/// Rows on their way into a writing transaction.
class Append {
 public:
  Append(const std::string& name, StoreTransaction& transaction, const StoreState& head,
         Duplicates rule)
      : name_(name), transaction_(transaction), rule_(rule) {
    result_.before = head;
    result_.state = head;
    ++result_.state.generation;
  }

  Result<void> add(std::span<const Experience> rows) {
    if (const auto checked = check_key_sizes(rows); !checked) return checked;
    std::vector<EncodedRow> encoded;
    std::vector<ContentHash> contents;
    for (const Experience& row : rows) contents.push_back(encoded.emplace_back(row).content());
    const auto found = transaction_.find_contents(contents);
    if (!found) return tl::unexpected(found.error());
    for (const KnownRow& row : *found) known_.insert_or_assign(row.content, row);
    std::vector<StoredRow> fresh;
    std::vector<Tombstone> superseded;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      take(encoded[i], rows[i].provenance, fresh, superseded);
    }
    known_.clear();
    return transaction_.add_rows(fresh).and_then(
        [&] { return transaction_.add_tombstones(superseded); });
  }

  /// Leaves the head alone if nothing was added.
  Result<Appended> finish() {
    const bool has_changed = result_.state.last_row != result_.before.last_row;
    if (!has_changed) result_.state = result_.before;
    const auto done =
        (has_changed ? transaction_.set_head(result_.state) : Result<void>()).and_then([&] {
          return transaction_.commit();
        });
    if (!done) return tl::unexpected(done.error());
    return std::move(result_);
  }

 private:
  /// Within the transaction, because another process may have added the first row of a kind.
  Result<void> check_key_sizes(std::span<const Experience> rows) {
    for (const Experience& row : rows) {
      if (!sizes_.knows(row.kind)) {
        const auto stored = transaction_.find_key_size(row.kind);
        if (!stored) return tl::unexpected(stored.error());
        (void)sizes_.check(row.kind, stored->value_or(row.key.size()));
      }
      if (const auto flaw = sizes_.check(row.kind, row.key.size())) {
        return fail(ErrorCode::invalid,
                    fmt::format("{}: a row cannot be inserted: {}", name_, *flaw));
      }
    }
    return {};
  }

  void take(const EncodedRow& row, const Provenance& provenance, std::vector<StoredRow>& fresh,
            std::vector<Tombstone>& superseded) {
    const auto known = known_.find(row.content());
    const bool is_known = known != known_.end();
    const bool is_earlier = is_known && rule_ == Duplicates::keep_earliest &&
                            std::tie(provenance.time, provenance.tool) <
                                std::tie(known->second.time, known->second.tool);
    result_.is_new.push_back(!is_known || is_earlier);
    if (is_known && !is_earlier) {
      result_.ids.push_back(known->second.id);
      return;
    }
    if (is_earlier) {
      superseded.push_back(make_tombstone(result_.state, known->second.id, "superseded"));
      ++result_.replaced_count;
    }
    StoreState& state = result_.state;
    const StoredRow stored = row.stored(++state.last_row, state.generation);
    ++state.row_count;
    state.row_digest ^= tally_mark(stored.id, stored.key_checksum);
    fresh.push_back(stored);
    result_.ids.push_back(stored.id);
    known_.insert_or_assign(row.content(),
                            KnownRow{row.content(), stored.id, provenance.time, provenance.tool});
  }

  const std::string& name_;  // of the store
  StoreTransaction& transaction_;
  Duplicates rule_;
  KeySizes sizes_;
  Appended result_;
  std::map<ContentHash, KnownRow> known_;
};

/// Counts what is there. Starts from the old head if that is legible.
Result<StoreState> recount(StoreTransaction& transaction) {
  const auto head = transaction.head();
  if (!head && head.error().code != ErrorCode::corrupt) return tl::unexpected(head.error());
  Tally tally(StoreState{});
  const auto counted =
      transaction
          .read_tombstones(0,
                           [&](const Tombstone& tombstone) {
                             tally.add(tombstone);
                             return Result<void>();
                           })
          .and_then([&] {
            return transaction.read_rows(0, RowParts::keys, [&](const StoredRow& row) {
              tally.add(row);
              return Result<void>();
            });
          });
  if (!counted) return tl::unexpected(counted.error());
  StoreState state = tally.found();
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

std::string current_time() {
  const auto time = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(time));
}

std::int64_t next_epoch(const StoreState* old_head) {
  if (old_head != nullptr) return old_head->epoch + 1;
  return std::chrono::system_clock::now().time_since_epoch() / std::chrono::microseconds(1);
}

Result<void> prepare_rows(std::vector<Experience>& rows, const ExperienceSpace& space) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (const auto flaw = describe_flaw(rows[i], space)) {
      return fail(ErrorCode::invalid,
                  fmt::format("row {} of {} cannot be inserted: {}", i, rows.size(), *flaw));
    }
    rows[i].sampler.joint_count = space.joint_count;
    if (rows[i].provenance.time.empty()) rows[i].provenance.time = current_time();
  }
  return {};
}

Result<Appended> append_rows(Store& store, std::span<const Experience> rows, Duplicates rule) {
  const auto all = [&](const StoreState&) { return Result<std::span<const Experience>>(rows); };
  return append_rows_of(store, all, rule);
}

Result<Appended> append_rows_of(Store& store, const RowSource& source, Duplicates rule) {
  constexpr std::size_t kRowsAtOnce = 2000;
  const auto transaction = store.begin(Store::Kind::write);
  if (!transaction) return tl::unexpected(transaction.error());
  const auto head = (*transaction)->head();
  if (!head) return tl::unexpected(head.error());
  const auto chosen = source(*head);
  if (!chosen) return tl::unexpected(chosen.error());
  Append append(store.name(), **transaction, *head, rule);
  for (auto rows = *chosen; !rows.empty();
       rows = rows.subspan(std::min(kRowsAtOnce, rows.size()))) {
    const auto added = append.add(rows.first(std::min(kRowsAtOnce, rows.size())));
    if (!added) return tl::unexpected(added.error());
  }
  return append.finish();
}

Result<void> quarantine_rows(Store& store, std::span<const Burial> burials,
                             std::span<const std::int64_t> damaged_tombstones) {
  const auto transaction = store.begin(Store::Kind::write);
  if (!transaction) return tl::unexpected(transaction.error());
  MNEME_TRY((*transaction)->remove_tombstones(damaged_tombstones));
  auto state = recount(**transaction);
  if (!state) return tl::unexpected(state.error());
  std::vector<Tombstone> tombstones;
  for (const Burial& burial : burials) {
    tombstones.push_back(make_tombstone(*state, burial.row, burial.reason));
  }
  return (*transaction)
      ->add_tombstones(tombstones)
      .and_then([&] { return (*transaction)->set_head(*state); })
      .and_then([&] { return (*transaction)->commit(); });
}

Result<std::int64_t> compact_store(Store& store) {
  std::int64_t removed = 0;
  {
    const auto transaction = store.begin(Store::Kind::write);
    if (!transaction) return tl::unexpected(transaction.error());
    const auto head = (*transaction)->head();
    if (!head) return tl::unexpected(head.error());
    if (head->tombstone_count > 0) {
      const auto cleared = (*transaction)->remove_dead();
      if (!cleared) return tl::unexpected(cleared.error());
      const auto state = recount(**transaction);
      if (!state) return tl::unexpected(state.error());
      removed = head->row_count - state->row_count;
      const auto done =
          (*transaction)->set_head(*state).and_then([&] { return (*transaction)->commit(); });
      if (!done) return tl::unexpected(done.error());
    }
  }
  return store.reclaim().map([&] { return removed; });
}

Result<void> merge_rows(Store& target, std::span<const Experience> rows, MergeSummary& summary) {
  return append_rows(target, rows, Duplicates::keep_earliest).map([&](const Appended& appended) {
    const auto added = std::ranges::count(appended.is_new, true);
    summary.read += static_cast<std::int64_t>(rows.size());
    summary.replaced += appended.replaced_count;
    summary.added += added - appended.replaced_count;
  });
}

}  // namespace mneme::internal
