// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Opens a database's file, with errors that say what to do.
#pragma once

#include "engines/sqlite_connection.h"

#include <cstdint>
#include <string>

namespace mneme::internal {

/// Checks the files of a database before anything opens them: opening a pipe would wait for ever.
/// The file may be missing. Errors: io if one of them is no regular file; corrupt if the file is
/// empty or missing, but its write-ahead log is not, which SQLite would delete.
[[nodiscard]] Result<void> check_files(const std::string& path);

/// Opens an existing file for reading, also in a read-only directory. Errors: io if the file is
/// missing or unreadable; corrupt if it is no SQLite file.
[[nodiscard]] Result<Connection> open_for_reading(const std::string& path);

/// Opens a file for writing; commits survive a loss of power. Errors: those of open_for_reading();
/// io if the file is not writable.
[[nodiscard]] Result<Connection> open_for_writing(const std::string& path, bool can_create);

/// Size of the file with its write-ahead log, bytes.
[[nodiscard]] std::int64_t bytes_on_disk(const std::string& path);

}  // namespace mneme::internal
