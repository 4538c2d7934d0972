// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A store on a PostgreSQL server.
#pragma once

#include "experience/postgres_connection.h"
#include "experience/store.h"

namespace mneme::internal {

/// Connects to the server that `url` names. Errors: io if that fails; unsupported if a newer mneme
/// created the tables.
[[nodiscard]] Result<std::unique_ptr<Store>> open_postgres_store(const std::string& url,
                                                                 OpenMode mode);
/// The same over a connection that its owner may also use, inside the store's transactions too.
[[nodiscard]] std::unique_ptr<Store> make_postgres_store(
    std::shared_ptr<PostgresConnection> connection, OpenMode mode);

}  // namespace mneme::internal
