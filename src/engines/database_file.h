// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A database's file: opening it, with reasons that a person can act on, and what saves a damaged
/// one.
#pragma once

#include "engines/sqlite_connection.h"

#include <cstdint>
#include <string>

namespace mneme::internal {

/// Opens an existing file to read it, also where nothing beside it can be created. Errors: io if
/// there is no such file, or it may not be read; corrupt if it is no SQLite file.
[[nodiscard]] Result<Connection> open_for_reading(const std::string& path);

/// Opens a file so that what is committed survives a loss of power. Errors: those of
/// open_for_reading, and io if it may not be written.
[[nodiscard]] Result<Connection> open_for_writing(const std::string& path, bool can_create);

/// The write-ahead log of a file, which stands beside what a link leads to.
[[nodiscard]] std::string log_path(const std::string& path);

/// Bytes of the file and of its write-ahead log.
[[nodiscard]] std::int64_t bytes_on_disk(const std::string& path);

/// The shell command that saves what can be read of a damaged file in a new one beside it: with
/// the sqlite3 program's .recover, or .dump where SQLite is built without the table that it reads.
[[nodiscard]] std::string saving_command(const std::string& path);

}  // namespace mneme::internal
