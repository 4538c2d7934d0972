// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A store and a shared task queue on a PostgreSQL server.
#pragma once

#include "engines/migration.h"
#include "engines/postgres_connection.h"
#include "store/store.h"
#include "engines/task_queue.h"

namespace mneme::internal {

/// Schema version of the tables in the search path: kSchemaVersion, kOldSchema, or 0 without
/// tables. Error: unsupported for other versions.
[[nodiscard]] Result<int> read_postgres_version(PostgresConnection& connection);
/// Reads the robot row. Error: corrupt if the row is missing or damaged.
[[nodiscard]] Result<RobotSignature> read_postgres_signature(PostgresConnection& connection);
/// Creates the tables in one transaction, unless another process already did.
[[nodiscard]] Result<void> create_postgres_schema(PostgresConnection& connection,
                                                  const RobotSignature& robot);
[[nodiscard]] Result<void> replace_postgres_signature(PostgresConnection& connection,
                                                      const RobotSignature& robot);
/// True if the table of lessons exists, which older builds did not create.
[[nodiscard]] Result<bool> has_postgres_lessons(PostgresConnection& connection);
/// Creates the table of lessons if it is missing. Call within a transaction with the head locked.
[[nodiscard]] Result<void> create_postgres_lessons(PostgresConnection& connection);
/// Reads the head row. `is_locked`: lock out other writers until the transaction ends.
[[nodiscard]] Result<StoreState> read_postgres_head(PostgresConnection& connection, bool is_locked);
[[nodiscard]] Result<void> write_postgres_head(PostgresConnection& connection,
                                               const StoreState& state);

/// Replaces the tables of kOldSchema by new ones; a reader hides them by temporary tables instead.
/// Call within a transaction with the head locked. `write_rows` receives the old rows.
[[nodiscard]] Result<void> migrate_tables(
    PostgresConnection& connection, OpenMode mode,
    const std::function<Result<void>(const OldRows&)>& write_rows);

/// Connects to the server of `url`. Migrates tables of kOldSchema; a reader migrates temporary
/// copies. Errors: io if connecting fails; unsupported for another schema.
[[nodiscard]] Result<std::unique_ptr<Store>> open_postgres_store(
    const std::string& url, OpenMode mode, const ServerPatience& patience = {});
/// Makes a store on a connection that its owner may also use, even inside the store's transactions.
[[nodiscard]] std::unique_ptr<Store> make_postgres_store(
    std::shared_ptr<PostgresConnection> connection, OpenMode mode);

/// Opens the queue and creates its table if missing. `url` holds a database of `signature`.
[[nodiscard]] Result<std::unique_ptr<TaskQueue>> open_postgres_tasks(
    const std::string& url, const RobotSignature& signature, TaskOwner owner);

}  // namespace mneme::internal
