// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A store in one SQLite file: tables (docs/design/database.md) and statements.
#pragma once

#include "mneme/store.h"

#include "engines/migration.h"
#include "engines/sqlite_connection.h"
#include "store/store.h"

#include <cstdint>

namespace mneme::internal {

/// Schema that this version reads and writes; PRAGMA user_version in a file.
inline constexpr int kSchemaVersion = 4;
/// PRAGMA application_id: "mnem".
inline constexpr std::int64_t kApplicationId = 0x6d6e656d;

/// Schema version of an open file: kSchemaVersion, kOldSchema, or 0 if it is empty or its creation
/// was interrupted. Errors: corrupt if the file belongs to another program or its tables were
/// changed; unsupported for another schema; io.
[[nodiscard]] Result<int> identify(Connection& connection);
/// Returns the error unsupported: a newer or older mneme wrote `name`.
[[nodiscard]] tl::unexpected<Error> refuse_schema(const std::string& name, std::int64_t version);

/// Creates the tables and the robot row in one transaction, unless another process already did.
[[nodiscard]] Result<void> create_schema(Connection& connection, const RobotSignature& robot);
/// Writes our application_id and user_version, which a file restored from .dump lacks.
[[nodiscard]] Result<void> mark(Connection& connection);

/// Checks the file's pages. Error: corrupt. A damaged file can be read in part, but writes to it
/// may be lost. Cost: about 1 ms per 2 MB.
[[nodiscard]] Result<void> check_pages(Connection& connection);

/// Errors: corrupt if the row is missing or damaged.
[[nodiscard]] Result<RobotSignature> read_signature(Connection& connection);
/// Within a transaction.
[[nodiscard]] Result<void> write_signature(Connection& connection, const RobotSignature& robot);
/// Errors: corrupt if the row is missing or damaged.
[[nodiscard]] Result<StoreState> read_head(Connection& connection);
/// Within a transaction.
[[nodiscard]] Result<void> write_head(Connection& connection, const StoreState& state);

/// Replaces the tables of kOldSchema by new ones, within a transaction. `write_rows` receives the
/// old rows.
[[nodiscard]] Result<void> migrate_tables(
    Connection& connection, const std::function<Result<void>(const OldRows&)>& write_rows);

/// Opens and identifies `path`. Migrates a file of kOldSchema; a reader migrates a copy in memory.
/// Reading also works in a read-only directory. Errors: io; corrupt; unsupported for another
/// schema.
[[nodiscard]] Result<std::unique_ptr<Store>> open_sqlite_store(const std::string& path,
                                                               OpenMode mode);

}  // namespace mneme::internal
