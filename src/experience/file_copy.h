// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Copies of a database file beside it.
#pragma once

#include "experience/sqlite_connection.h"

#include <string>

namespace mneme::internal {

/// Copies what `source` holds to `PATH.suffix`, or `PATH.suffix.2` and so on if that is taken, and
/// returns the name. The copy is on the disk, whole, before it has that name.
[[nodiscard]] Result<std::string> copy_beside(Connection& source, const std::string& path,
                                              const std::string& suffix);

/// Removes a file and what SQLite keeps beside it.
void remove_with_logs(const std::string& path);

}  // namespace mneme::internal
