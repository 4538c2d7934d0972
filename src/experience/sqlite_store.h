// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A store in one SQLite file.
#pragma once

#include "experience/sqlite_connection.h"
#include "experience/store.h"

namespace mneme::internal {

/// Opens `path` and reads what it is. A reader works where nothing may be written, too. Errors: io;
/// corrupt; unsupported if a newer mneme wrote it.
[[nodiscard]] Result<std::unique_ptr<Store>> open_sqlite_store(const std::string& path,
                                                               OpenMode mode);

}  // namespace mneme::internal
