// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The tables of a database on a PostgreSQL server, drawn in docs/database.md.
#pragma once

#include "experience/postgres_connection.h"
#include "experience/store.h"

namespace mneme::internal {

/// The schema version of the tables in the search path; 0 if there are none. Errors: unsupported if
/// a newer mneme created them.
[[nodiscard]] Result<int> read_postgres_version(PostgresConnection& connection);
/// Errors: corrupt if the row is missing or damaged.
[[nodiscard]] Result<ExperienceSpace> read_postgres_space(PostgresConnection& connection);
/// Creates the tables in one transaction, unless another process was faster.
[[nodiscard]] Result<void> create_postgres_schema(PostgresConnection& connection,
                                                  const ExperienceSpace& space);
/// `is_locked` keeps other writers out until the transaction ends.
[[nodiscard]] Result<StoreState> read_postgres_head(PostgresConnection& connection, bool is_locked);
[[nodiscard]] Result<void> write_postgres_head(PostgresConnection& connection,
                                               const StoreState& state);

}  // namespace mneme::internal
