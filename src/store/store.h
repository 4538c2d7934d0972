// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Where experience is kept: the one interface that every engine implements.
#pragma once

#include "mneme/store.h"

#include "store/row_codec.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// A live row with a content that was asked for.
struct KnownRow {
  ContentHash content{};
  std::int64_t id = 0;
  Provenance provenance;
};

/// How much of each row to read.
enum class RowParts {
  keys,  ///< without the mixture: a tenth of the bytes
  all,
};

using RowVisitor = std::function<Result<void>(const StoredRow&)>;
using TombstoneVisitor = std::function<Result<void>(const Tombstone&)>;

/// One transaction; rolls back unless it is committed. Reads see one snapshot. Not thread-safe.
/// Errors of all calls: io, corrupt, and whatever a visitor returns.
class StoreTransaction {
 public:
  virtual ~StoreTransaction() = default;

  /// corrupt if it is damaged. Of a writing transaction: no other can begin until this one ends.
  [[nodiscard]] virtual Result<StoreState> head() = 0;
  /// Those after the id `after`, in order of ids.
  [[nodiscard]] virtual Result<void> read_tombstones(std::int64_t after,
                                                     const TombstoneVisitor& visit) = 0;
  /// Dead ones included.
  [[nodiscard]] virtual Result<void> read_rows(std::int64_t after, RowParts parts,
                                               const RowVisitor& visit) = 0;
  /// Whole rows in any order; ids that do not exist are passed over.
  [[nodiscard]] virtual Result<void> read_rows_by_id(std::span<const std::int64_t> ids,
                                                     const RowVisitor& visit) = 0;
  /// The live rows with one of these contents.
  [[nodiscard]] virtual Result<std::vector<KnownRow>> find_contents(
      std::span<const ContentHash> contents) = 0;
  /// How many numbers the key of the first live row of a kind has, if there is one.
  [[nodiscard]] virtual Result<std::optional<std::size_t>> find_key_size(std::string_view kind) = 0;
  /// Ids with a mixture but no key, unless they have a tombstone.
  [[nodiscard]] virtual Result<std::vector<std::int64_t>> find_orphans() = 0;

  // Of writing transactions only.
  [[nodiscard]] virtual Result<void> add_rows(std::span<const StoredRow> rows) = 0;
  [[nodiscard]] virtual Result<void> add_tombstones(std::span<const Tombstone> tombstones) = 0;
  [[nodiscard]] virtual Result<void> remove_tombstones(std::span<const std::int64_t> ids) = 0;
  [[nodiscard]] virtual Result<void> set_head(const StoreState& state) = 0;
  /// Removes all rows with a tombstone, and the tombstones.
  [[nodiscard]] virtual Result<void> remove_dead() = 0;
  [[nodiscard]] virtual Result<void> commit() = 0;
};

/// An open store. Not thread-safe. Errors name its URL.
class Store {
 public:
  enum class Kind { read, write };
  virtual ~Store() = default;

  /// For messages: without a password.
  [[nodiscard]] virtual const std::string& name() const = 0;
  /// 0 if there is nothing in it yet.
  [[nodiscard]] virtual Result<int> schema_version() = 0;
  /// Only of a store whose schema version is not 0.
  [[nodiscard]] virtual Result<RobotSignature> signature() = 0;
  /// Creates the tables of an empty store, unless another process was faster.
  [[nodiscard]] virtual Result<void> create(const RobotSignature& signature) = 0;
  [[nodiscard]] virtual Result<std::unique_ptr<StoreTransaction>> begin(Kind kind) = 0;
  [[nodiscard]] virtual Result<std::int64_t> bytes() = 0;
  /// Adds what is wrong with the files beneath the rows.
  [[nodiscard]] virtual Result<void> check_structure(std::vector<Damage>& damages) = 0;
  /// Gives the space of removed rows back.
  [[nodiscard]] virtual Result<void> reclaim() = 0;
  /// Says of a store that has a robot that it is of another one.
  [[nodiscard]] virtual Result<void> set_signature(const RobotSignature& signature) = 0;
};

}  // namespace mneme::internal
