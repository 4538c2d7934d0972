// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The tables of a database file, drawn in docs/database.md.
#pragma once

#include "mneme/experience.h"
#include "experience/sqlite_connection.h"

#include <cstdint>

namespace mneme::internal {

/// Of the databases that this version reads and writes. A file's is its PRAGMA user_version.
inline constexpr int kSchemaVersion = 3;
/// PRAGMA application_id: "mnem".
inline constexpr std::int64_t kApplicationId = 0x6d6e656d;

/// kSchemaVersion, or 0 if nothing is in an open file yet, or its creation was cut short. Errors:
/// corrupt if the file is another program's or its tables are not as they were created; unsupported
/// if another mneme wrote it; io.
[[nodiscard]] Result<int> identify(Connection& connection);
/// Error: unsupported, because `name` was written by a newer or an older mneme.
[[nodiscard]] tl::unexpected<Error> refuse_schema(const std::string& name, std::int64_t version);

/// Creates the tables and the row of `space` in one transaction, unless another process was faster.
[[nodiscard]] Result<void> create_schema(Connection& connection, const ExperienceSpace& space);

/// Errors: corrupt if the file's pages do not fit together. A damaged file can still be read in
/// part; what is written to it may be lost. About 1 ms per 2 MB.
[[nodiscard]] Result<void> check_pages(Connection& connection);

/// Errors: corrupt if the row is missing or damaged.
[[nodiscard]] Result<ExperienceSpace> read_space(Connection& connection);

}  // namespace mneme::internal
