// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The statements of an SQLite file.
#pragma once

#include "experience/sqlite_connection.h"
#include "experience/store.h"

namespace mneme::internal {

[[nodiscard]] Result<StoreState> read_head(Connection& connection);
[[nodiscard]] Result<void> write_head(Connection& connection, const StoreState& state);

// What StoreTransaction says of its functions of the same names.
[[nodiscard]] Result<void> read_tombstones(Connection& connection, std::int64_t after,
                                           const TombstoneVisitor& visit);
[[nodiscard]] Result<void> read_rows(Connection& connection, std::int64_t after, RowParts parts,
                                     const RowVisitor& visit);
[[nodiscard]] Result<void> read_rows_by_id(Connection& connection,
                                           std::span<const std::int64_t> ids,
                                           const RowVisitor& visit);
[[nodiscard]] Result<std::vector<KnownRow>> find_contents(Connection& connection,
                                                          std::span<const ContentHash> contents);
[[nodiscard]] Result<std::optional<std::size_t>> find_key_size(Connection& connection,
                                                               std::string_view kind);
[[nodiscard]] Result<std::vector<std::int64_t>> find_orphans(Connection& connection);
[[nodiscard]] Result<void> add_rows(Connection& connection, std::span<const StoredRow> rows);
[[nodiscard]] Result<void> add_tombstones(Connection& connection,
                                          std::span<const Tombstone> tombstones);
[[nodiscard]] Result<void> remove_dead(Connection& connection);

}  // namespace mneme::internal
