// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Bringing an SQLite file of an older schema to the present one.
#pragma once

#include "mneme/experience.h"

#include <string>

namespace mneme::internal {

/// Copies the file beside it, then migrates it in one transaction; whoever is killed in between
/// leaves the file as it was. Rows that are damaged, or that say what another one says, stay behind
/// in the copy.
[[nodiscard]] Result<MigrateSummary> migrate_file(const std::string& path);

}  // namespace mneme::internal
