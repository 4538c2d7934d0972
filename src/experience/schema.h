// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The tables of a database file, drawn in docs/database.md.
#pragma once

#include "mneme/experience.h"
#include "experience/sqlite_connection.h"

#include <cstdint>

namespace mneme::internal {

/// PRAGMA user_version of the files that this version writes; it reads no newer ones.
inline constexpr int kSchemaVersion = 1;
/// PRAGMA application_id: "mnem".
inline constexpr std::int64_t kApplicationId = 0x6d6e656d;

/// What an open file is.
enum class FileKind {
  empty,     ///< nothing in it yet, or its creation was cut short
  database,  ///< ours, with the tables that its schema version calls for
};
/// Errors: corrupt if the file is another program's or its tables are not as they were created;
/// unsupported if a newer mneme wrote it; io.
[[nodiscard]] Result<FileKind> identify(Connection& connection);

/// Creates the tables and the row of `space` in one transaction, unless another process was faster.
[[nodiscard]] Result<void> create_schema(Connection& connection, const ExperienceSpace& space);

/// Errors: corrupt if the file's pages do not fit together. A damaged file can still be read in
/// part; what is written to it may be lost. About 1 ms per 2 MB.
[[nodiscard]] Result<void> check_pages(Connection& connection);

/// Errors: corrupt if the row is missing or damaged.
[[nodiscard]] Result<ExperienceSpace> read_space(Connection& connection);

}  // namespace mneme::internal
