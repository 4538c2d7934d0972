// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A store in one SQLite file: its tables, which docs/design/database.md draws, and their
/// statements.
#pragma once

#include "mneme/store.h"

#include "engines/migration.h"
#include "engines/sqlite_connection.h"
#include "store/store.h"

#include <cstdint>

namespace mneme::internal {

/// Of the databases that this version reads and writes. A file's is its PRAGMA user_version.
inline constexpr int kSchemaVersion = 4;
/// PRAGMA application_id: "mnem".
inline constexpr std::int64_t kApplicationId = 0x6d6e656d;

/// kSchemaVersion or kOldSchema; 0 if nothing is in an open file yet, or its creation was cut
/// short. Errors: corrupt if the file is another program's or its tables are not as they were
/// created; unsupported if it has another schema; io.
[[nodiscard]] Result<int> identify(Connection& connection);
/// Error: unsupported, because `name` was written by a newer or an older mneme.
[[nodiscard]] tl::unexpected<Error> refuse_schema(const std::string& name, std::int64_t version);

/// Creates the tables and the row of the robot in one transaction, unless another process was
/// faster.
[[nodiscard]] Result<void> create_schema(Connection& connection, const RobotSignature& robot);
/// Says in a file that was saved by .dump that it is ours.
[[nodiscard]] Result<void> mark(Connection& connection);

/// Errors: corrupt if the file's pages do not fit together. A damaged file can still be read in
/// part; what is written to it may be lost. About 1 ms per 2 MB.
[[nodiscard]] Result<void> check_pages(Connection& connection);

/// Errors: corrupt if the row is missing or damaged.
[[nodiscard]] Result<RobotSignature> read_signature(Connection& connection);
/// Within a transaction.
[[nodiscard]] Result<void> write_signature(Connection& connection, const RobotSignature& robot);
/// Errors: corrupt if the row is missing or damaged.
[[nodiscard]] Result<StoreState> read_head(Connection& connection);
/// Within a transaction.
[[nodiscard]] Result<void> write_head(Connection& connection, const StoreState& state);

/// Within a transaction: replaces the tables of kOldSchema by ours. `write_rows` is given its rows.
[[nodiscard]] Result<void> migrate_tables(
    Connection& connection, const std::function<Result<void>(const OldRows&)>& write_rows);

/// Opens `path` and reads what it is; a file of kOldSchema is brought up to ours, or, by a reader,
/// a copy of it in memory. A reader works where nothing may be written, too. Errors: io; corrupt;
/// unsupported if it has another schema.
[[nodiscard]] Result<std::unique_ptr<Store>> open_sqlite_store(const std::string& path,
                                                               OpenMode mode);

}  // namespace mneme::internal
