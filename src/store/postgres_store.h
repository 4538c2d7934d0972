// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A store, and tasks that processes share, on a PostgreSQL server.
#pragma once

#include "store/postgres_connection.h"
#include "store/store.h"
#include "store/task_queue.h"

namespace mneme::internal {

/// The schema version of the tables in the search path; 0 if there are none. Errors: unsupported if
/// a newer mneme created them.
[[nodiscard]] Result<int> read_postgres_version(PostgresConnection& connection);
/// Errors: corrupt if the row is missing or damaged.
[[nodiscard]] Result<ExperienceSpace> read_postgres_space(PostgresConnection& connection);
/// Creates the tables in one transaction, unless another process was faster.
[[nodiscard]] Result<void> create_postgres_schema(PostgresConnection& connection,
                                                  const ExperienceSpace& space);
[[nodiscard]] Result<void> replace_postgres_space(PostgresConnection& connection,
                                                  const ExperienceSpace& space);
/// `is_locked` keeps other writers out until the transaction ends.
[[nodiscard]] Result<StoreState> read_postgres_head(PostgresConnection& connection, bool is_locked);
[[nodiscard]] Result<void> write_postgres_head(PostgresConnection& connection,
                                               const StoreState& state);

/// Connects to the server that `url` names. Errors: io if that fails; unsupported if a newer mneme
/// created the tables.
[[nodiscard]] Result<std::unique_ptr<Store>> open_postgres_store(const std::string& url,
                                                                 OpenMode mode);
/// The same over a connection that its owner may also use, inside the store's transactions too.
[[nodiscard]] std::unique_ptr<Store> make_postgres_store(
    std::shared_ptr<PostgresConnection> connection, OpenMode mode);

/// Makes the table if it is missing. `url` holds a database of `space`.
[[nodiscard]] Result<std::unique_ptr<TaskQueue>> open_postgres_tasks(const std::string& url,
                                                                     const ExperienceSpace& space,
                                                                     TaskOwner owner);

}  // namespace mneme::internal
