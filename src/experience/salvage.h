// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Saving what can be read of a file whose pages do not fit together.
#pragma once

#include "experience/sqlite_connection.h"
#include "experience/store.h"

#include <string>
#include <vector>

namespace mneme::internal {

/// Replaces the file by one of the present schema with the sound live rows of the old one, each
/// under its id, in one transaction. Adds the rows that cannot be saved to `damages`, unless they
/// are named there already. Returns the name of a copy of the old file. Errors: corrupt if not even
/// the space can be read; io.
[[nodiscard]] Result<std::string> salvage_file(Connection& damaged, std::vector<Damage>& damages);

}  // namespace mneme::internal
