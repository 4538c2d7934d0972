// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A store in one SQLite file: tables (docs/design/database.md) and statements.
#pragma once

#include "mneme/store.h"

#include "engines/migration.h"
#include "engines/sqlite_connection.h"
#include "store/store.h"

#include <atomic>
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
/// Returns the schema version that it found, 0 if it created them.
[[nodiscard]] Result<int> create_schema(Connection& connection, const RobotSignature& robot);
/// Writes mneme's application_id and user_version, which a file restored from .dump lacks.
[[nodiscard]] Result<void> mark(Connection& connection);

/// True if the table of lessons exists, which older builds did not create.
[[nodiscard]] Result<bool> has_lessons(Connection& connection);
/// Creates the table of lessons if it is missing.
[[nodiscard]] Result<void> create_lessons(Connection& connection);

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

/// How long a writer waits for another process that migrates the file, which takes about 1 min per
/// GB.
inline constexpr int kMigrationTimeoutMs = 600000;

/// Opens and identifies `path`. Migrates a file of kOldSchema; a reader migrates a copy in memory.
/// Reading also works in a read-only directory. Errors: io; corrupt, also if acknowledged rows are
/// missing, unless `check` says otherwise; unsupported for another schema. `stop`, if not null,
/// ends later waits for other processes (Connection::set_stop()).
[[nodiscard]] Result<std::unique_ptr<Store>> open_sqlite_store(
    const std::string& path, OpenMode mode, LossCheck check = LossCheck::refuse,
    int migration_timeout_ms = kMigrationTimeoutMs, const std::atomic<bool>* stop = nullptr);

/// A store in a file that does not exist yet: the first writing transaction creates it, so that
/// a process that stores nothing leaves no file. `stop` as in open_sqlite_store(). Errors: io if
/// its directory is not writable.
[[nodiscard]] Result<std::unique_ptr<Store>> new_sqlite_store(
    const std::string& path, const RobotSignature& robot, const std::atomic<bool>* stop = nullptr);

}  // namespace mneme::internal
