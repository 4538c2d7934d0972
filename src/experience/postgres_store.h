// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A store on a PostgreSQL server.
#pragma once

#include "experience/store.h"

namespace mneme::internal {

/// Connects to the server that `url` names. Errors: io if that fails; unsupported if a newer mneme
/// created the tables.
[[nodiscard]] Result<std::unique_ptr<Store>> open_postgres_store(const std::string& url,
                                                                 OpenMode mode);

}  // namespace mneme::internal
