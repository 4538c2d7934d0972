// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A store in one SQLite file: its tables, which docs/database.md draws, and their statements.
#pragma once

#include "mneme/store.h"

#include "store/sqlite_connection.h"
#include "store/store.h"

#include <cstdint>

namespace mneme::internal {

/// Of the databases that this version reads and writes. A file's is its PRAGMA user_version.
inline constexpr int kSchemaVersion = 3;
/// PRAGMA application_id: "mnem".
inline constexpr std::int64_t kApplicationId = 0x6d6e656d;

/// kSchemaVersion, or 0 if nothing is in an open file yet, or its creation was cut short. Errors:
/// corrupt if the file is another program's or its tables are not as they were created; unsupported
/// if another mneme wrote it; io.
[[nodiscard]] Result<int> identify(Connection& connection);
/// Says in a file that was saved by .dump that it is ours.
[[nodiscard]] Result<void> mark(Connection& connection);
/// Error: unsupported, because `name` was written by a newer or an older mneme.
[[nodiscard]] tl::unexpected<Error> refuse_schema(const std::string& name, std::int64_t version);

/// Creates the tables and the row of `space` in one transaction, unless another process was faster.
[[nodiscard]] Result<void> create_schema(Connection& connection, const ExperienceSpace& space);

/// Errors: corrupt if the file's pages do not fit together. A damaged file can still be read in
/// part; what is written to it may be lost. About 1 ms per 2 MB.
[[nodiscard]] Result<void> check_pages(Connection& connection);

/// Errors: corrupt if the row is missing or damaged.
[[nodiscard]] Result<ExperienceSpace> read_space(Connection& connection);
[[nodiscard]] Result<void> replace_space(Connection& connection, const ExperienceSpace& space);

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

/// Opens `path` and reads what it is. A reader works where nothing may be written, too. Errors: io;
/// corrupt; unsupported if a newer mneme wrote it.
[[nodiscard]] Result<std::unique_ptr<Store>> open_sqlite_store(const std::string& path,
                                                               OpenMode mode);

}  // namespace mneme::internal
