// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/fail.h"
#include "base/text.h"
#include "store/store.h"
#include "store/row_check.h"

#include <algorithm>
#include <map>
#include <tuple>

namespace mneme::internal {
namespace {

/// Equal rows are kept in this order, whichever comes first.
auto order_of(const Provenance& provenance) {
  return std::tie(provenance.time, provenance.tool, provenance.settings, provenance.seed);
}

std::vector<LessonMark> lessons_of(std::span<const Experience> rows,
                                   std::span<const ContentHash> contents) {
  std::vector<LessonMark> marks;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::uint64_t lesson = rows[i].provenance.lesson;
    if (lesson != 0) marks.push_back({lesson, contents[i]});
  }
  return marks;
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
    MNEME_TRY(check_key_sizes(rows));
    std::vector<EncodedRow> encoded;
    std::vector<ContentHash> contents;
    for (const Experience& row : rows) contents.push_back(encoded.emplace_back(row).content());
    const auto found = MNEME_TRY(transaction_.find_contents(contents));
    for (const KnownRow& row : found) known_.insert_or_assign(row.content, row);
    std::vector<StoredRow> fresh;
    std::vector<Tombstone> superseded;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      take(encoded[i], rows[i].provenance, fresh, superseded);
    }
    known_.clear();
    MNEME_TRY(transaction_.add_rows(fresh));
    MNEME_TRY(transaction_.add_tombstones(superseded));
    return transaction_.add_lessons(lessons_of(rows, contents));
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
        const auto stored = MNEME_TRY(transaction_.find_key_size(row.kind));
        (void)sizes_.check(row.kind, stored.value_or(row.key.size()));
      }
      if (const auto flaw = sizes_.check(row.kind, row.key.size())) {
        return fail(ErrorCode::invalid, "{}: a row cannot be inserted: {}", name_, *flaw);
      }
    }
    return {};
  }

  void take(const EncodedRow& row, const Provenance& provenance, std::vector<StoredRow>& fresh,
            std::vector<Tombstone>& superseded) {
    const auto known = known_.find(row.content());
    const bool is_known = known != known_.end();
    const bool is_earlier = is_known && rule_ == Duplicates::keep_earliest &&
                            order_of(provenance) < order_of(known->second.provenance);
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
    const StoredRow stored = row.stored(state.last_row + 1, state.generation);
    count(stored, state);
    fresh.push_back(stored);
    result_.ids.push_back(stored.id);
    known_.insert_or_assign(row.content(), KnownRow{row.content(), stored.id, provenance});
  }

  const std::string& name_;
  StoreTransaction& transaction_;
  Duplicates rule_;
  KeySizes sizes_;
  Appended result_;
  std::map<ContentHash, KnownRow> known_;
};

}  // namespace

Tombstone make_tombstone(StoreState& state, std::int64_t row, std::string reason) {
  Tombstone tombstone{state.last_tombstone + 1, row, state.generation, std::move(reason),
                      current_time(),           0};
  tombstone.checksum = checksum_of(tombstone);
  count(tombstone, state);
  return tombstone;
}

Result<void> prepare_rows(std::vector<Experience>& rows, const RobotSignature& signature) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (const auto flaw = describe_flaw(rows[i], signature)) {
      return fail(ErrorCode::invalid, "row {} of {} cannot be inserted: {}", i, rows.size(), *flaw);
    }
    if (!rows[i].is_path()) rows[i].sampler().joint_count = signature.joint_count;
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
  const auto transaction = MNEME_TRY(store.begin(Store::Kind::write));
  const auto head = MNEME_TRY(transaction->head());
  const auto chosen = MNEME_TRY(source(head));
  Append append(store.name(), *transaction, head, rule);
  for (auto rows = chosen; !rows.empty(); rows = rows.subspan(std::min(kRowsAtOnce, rows.size()))) {
    MNEME_TRY(append.add(rows.first(std::min(kRowsAtOnce, rows.size()))));
  }
  return append.finish();
}

}  // namespace mneme::internal
