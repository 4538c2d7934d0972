// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A store, and tasks that processes share, on a PostgreSQL server.
#pragma once

#include "engines/migration.h"
#include "engines/postgres_connection.h"
#include "store/store.h"
#include "engines/task_queue.h"

namespace mneme::internal {

/// The schema version of the tables in the search path, kOldSchema included; 0 if there are none.
/// Errors: unsupported for any other.
[[nodiscard]] Result<int> read_postgres_version(PostgresConnection& connection);
/// Errors: corrupt if the row is missing or damaged.
[[nodiscard]] Result<RobotSignature> read_postgres_signature(PostgresConnection& connection);
/// Creates the tables in one transaction, unless another process was faster.
[[nodiscard]] Result<void> create_postgres_schema(PostgresConnection& connection,
                                                  const RobotSignature& robot);
[[nodiscard]] Result<void> replace_postgres_signature(PostgresConnection& connection,
                                                      const RobotSignature& robot);
/// `is_locked` keeps other writers out until the transaction ends.
[[nodiscard]] Result<StoreState> read_postgres_head(PostgresConnection& connection, bool is_locked);
[[nodiscard]] Result<void> write_postgres_head(PostgresConnection& connection,
                                               const StoreState& state);

/// Within a transaction, with the head locked: replaces the tables of kOldSchema by ours, or, for a
/// reader, hides them by temporary ones. `write_rows` is given its rows.
[[nodiscard]] Result<void> migrate_tables(
    PostgresConnection& connection, OpenMode mode,
    const std::function<Result<void>(const OldRows&)>& write_rows);

/// Connects to the server that `url` names. Tables of kOldSchema are brought up to ours, or, by a
/// reader, temporary copies of them. Errors: io if that fails; unsupported for another schema.
[[nodiscard]] Result<std::unique_ptr<Store>> open_postgres_store(const std::string& url,
                                                                 OpenMode mode);
/// The same over a connection that its owner may also use, inside the store's transactions too.
[[nodiscard]] std::unique_ptr<Store> make_postgres_store(
    std::shared_ptr<PostgresConnection> connection, OpenMode mode);

/// Makes the table if it is missing. `url` holds a database of `signature`.
[[nodiscard]] Result<std::unique_ptr<TaskQueue>> open_postgres_tasks(
    const std::string& url, const RobotSignature& signature, TaskOwner owner);

}  // namespace mneme::internal
