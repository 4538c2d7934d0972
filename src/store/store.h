// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The interface that every database engine implements, and what all engines share: reading changes
/// since a known state, and appending rows. A writing transaction also updates the head.
#pragma once

#include "mneme/store.h"

#include "store/row_codec.h"

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// A live row (not set aside) with one of the requested contents.
struct KnownRow {
  ContentHash content{};
  std::int64_t id = 0;
  Provenance provenance;
};

/// Records that a lesson taught the row with this content; see Provenance::lesson.
struct LessonMark {
  std::uint64_t lesson = 0;
  ContentHash content{};
  bool is_live = true;  ///< a live row has the content; ignored when marks are added
};

/// How much of each row to read.
enum class RowParts {
  keys,  ///< without the mixture: a tenth of the bytes
  all,
};

using RowVisitor = std::function<Result<void>(const StoredRow&)>;
using TombstoneVisitor = std::function<Result<void>(const Tombstone&)>;

/// One transaction; rolls back unless committed. Reads see one snapshot. Not thread-safe. Errors of
/// all calls: io, corrupt, and errors of visitors.
class StoreTransaction {
 public:
  virtual ~StoreTransaction() = default;

  /// The store's state. In a writing transaction it stays locked until the end. Error: corrupt.
  [[nodiscard]] virtual Result<StoreState> head() = 0;
  /// Visits tombstones with ids above `after`, in order of ids.
  [[nodiscard]] virtual Result<void> read_tombstones(std::int64_t after,
                                                     const TombstoneVisitor& visit) = 0;
  /// Visits rows with ids above `after`, including dead ones, in order of ids.
  [[nodiscard]] virtual Result<void> read_rows(std::int64_t after, RowParts parts,
                                               const RowVisitor& visit) = 0;
  /// Visits whole rows in any order; skips ids that do not exist.
  [[nodiscard]] virtual Result<void> read_rows_by_id(std::span<const std::int64_t> ids,
                                                     const RowVisitor& visit) = 0;
  /// Live rows with one of these contents.
  [[nodiscard]] virtual Result<std::vector<KnownRow>> find_contents(
      std::span<const ContentHash> contents) = 0;
  /// Key length of the first live row of a kind; nothing if there is no row.
  [[nodiscard]] virtual Result<std::optional<std::size_t>> find_key_size(std::string_view kind) = 0;
  /// Ids of rows with a mixture but without a key and tombstone.
  [[nodiscard]] virtual Result<std::vector<std::int64_t>> find_orphans() = 0;

  /// All records of finished lessons.
  [[nodiscard]] virtual Result<std::vector<LessonMark>> read_lessons() = 0;

  // Only in writing transactions:
  [[nodiscard]] virtual Result<void> add_rows(std::span<const StoredRow> rows) = 0;
  [[nodiscard]] virtual Result<void> add_tombstones(std::span<const Tombstone> tombstones) = 0;
  /// Adds the records of lessons that the store does not have yet.
  [[nodiscard]] virtual Result<void> add_lessons(std::span<const LessonMark> marks) = 0;
  [[nodiscard]] virtual Result<void> remove_tombstones(std::span<const std::int64_t> ids) = 0;
  [[nodiscard]] virtual Result<void> set_head(const StoreState& state) = 0;
  /// Deletes all rows that have a tombstone, and the tombstones.
  [[nodiscard]] virtual Result<void> remove_dead() = 0;
  [[nodiscard]] virtual Result<void> commit() = 0;
};

/// Reaction of opening a store to missing rows that were acknowledged as stored.
enum class LossCheck {
  refuse,  ///< error: corrupt
  note,    ///< open it nevertheless; Store::loss() describes what is missing
};

/// How long calls wait for a server, or for another process that locks a file.
struct ServerPatience {
  double answer_s = 10;  ///< seconds from the begin of a call to its answer, of streams to each row
  /// Set by another thread to end waiting calls within 20 ms, and all later ones that would wait at
  /// once; may be null.
  const std::atomic<bool>* stop = nullptr;
};

/// How open_store() opens a store.
struct OpenOptions {
  LossCheck loss_check = LossCheck::refuse;
  ServerPatience patience = {};
};

/// An open store. Not thread-safe. Errors name its URL.
class Store {
 public:
  enum class Kind { read, write };
  virtual ~Store() = default;

  /// URL without password, for messages.
  [[nodiscard]] virtual const std::string& name() const = 0;
  /// 0 if the store is empty.
  [[nodiscard]] virtual Result<int> schema_version() = 0;
  /// Precondition: the schema version is not 0.
  [[nodiscard]] virtual Result<RobotSignature> signature() = 0;
  /// Creates the tables, unless another process already did.
  [[nodiscard]] virtual Result<void> create(const RobotSignature& signature) = 0;
  [[nodiscard]] virtual Result<std::unique_ptr<StoreTransaction>> begin(Kind kind) = 0;
  [[nodiscard]] virtual Result<std::int64_t> bytes() = 0;
  /// Acknowledged rows that the store no longer holds, in words, found when it was opened with
  /// LossCheck::note; nothing if there is no loss.
  [[nodiscard]] virtual const std::optional<std::string>& loss() const = 0;
  /// Why losses of the store's last rows would not be noticed: its record is damaged, of another
  /// database, or cannot be written. Empty if they would be, and for a copy without a record.
  [[nodiscard]] virtual const std::string& record_flaw() const {
    static const std::string none;
    return none;
  }
  /// Appends damage of the underlying files to `damages`.
  [[nodiscard]] virtual Result<void> check_structure(std::vector<Damage>& damages) = 0;
  /// Frees the space of deleted rows.
  [[nodiscard]] virtual Result<void> reclaim() = 0;
  /// Replaces the robot signature of a store that has one.
  [[nodiscard]] virtual Result<void> set_signature(const RobotSignature& signature) = 0;
};

/// Adds a row or tombstone that is read or written to the counts, digests and last numbers of
/// `state`.
void count(const StoredRow& row, StoreState& state);
void count(const Tombstone& tombstone, StoreState& state);

/// Difference of what was counted from the store's head, in words: rows missing, added or
/// renumbered. Nothing if equal.
[[nodiscard]] std::optional<std::string> describe_difference(const StoreState& counted,
                                                             const StoreState& head);

/// Changes of a store since a known state.
struct StoreChanges {
  StoreState state;
  bool is_complete = false;     ///< all rows were read, not only new ones
  std::set<std::int64_t> dead;  ///< all dead rows, including newly dead ones
};

/// Visits the live rows added after `since` in one snapshot; all live rows if some may have been
/// deleted. Error: corrupt if count or checksums differ from what was inserted.
[[nodiscard]] Result<StoreChanges> read_changes(Store& store, const StoreState& since,
                                                RowParts parts, const RowVisitor& visit);

/// Which of two rows with equal content is kept.
enum class Duplicates {
  keep_first,     ///< keep the stored row
  keep_earliest,  ///< keep the row with the smaller (time, tool, settings, seed), independent of
                  ///< insertion order
};

struct Appended {
  std::vector<std::int64_t> ids;    ///< per row: its own id, or the id of the stored row with equal
                                    ///< content
  std::vector<bool> is_new;         ///< per row
  std::int64_t replaced_count = 0;  ///< stored rows replaced by new ones
  StoreState before;                ///< state before the insertion
  StoreState state;
};

/// Checks rows and completes joint counts and times. Error: invalid, naming the row.
[[nodiscard]] Result<void> prepare_rows(std::vector<Experience>& rows,
                                        const RobotSignature& signature);

/// Appends all rows or none; skips rows whose content is already stored. The rows must have passed
/// prepare_rows().
[[nodiscard]] Result<Appended> append_rows(Store& store, std::span<const Experience> rows,
                                           Duplicates rule);

/// Chooses the rows to append, inside the transaction and with the head locked. Changes that this
/// function makes are committed or rolled back with the rows.
using RowSource = std::function<Result<std::span<const Experience>>(const StoreState& head)>;
[[nodiscard]] Result<Appended> append_rows_of(Store& store, const RowSource& source,
                                              Duplicates rule);

/// Makes a tombstone for `row` and counts it in `state`.
[[nodiscard]] Tombstone make_tombstone(StoreState& state, std::int64_t row, std::string reason);

}  // namespace mneme::internal
