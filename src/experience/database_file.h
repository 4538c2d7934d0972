// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Opening a database's file, with reasons that a person can act on.
#pragma once

#include "experience/sqlite_connection.h"

#include <cstdint>
#include <string>

namespace mneme::internal {

/// Opens an existing file to read it, also where nothing beside it can be created. Errors: io if
/// there is no such file, or it may not be read; corrupt if it is no SQLite file.
[[nodiscard]] Result<Connection> open_for_reading(const std::string& path);

/// Opens a file so that what is committed survives a loss of power. Errors: those of
/// open_for_reading, and io if it may not be written.
[[nodiscard]] Result<Connection> open_for_writing(const std::string& path, bool can_create);

/// Bytes of the file and of its write-ahead log.
[[nodiscard]] std::int64_t bytes_on_disk(const std::string& path);

}  // namespace mneme::internal
