// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Saving what can be read of a file whose pages do not fit together.
#pragma once

#include "mneme/experience.h"

#include <string>
#include <vector>

namespace mneme::internal {

/// Replaces the file by one of the present schema with the sound live rows of the old one, each
/// under its id, in one transaction. Rows are read from the leaves they stand in, so that a damaged
/// header or schema, or lost pages, cost no other rows. Adds what cannot be saved to `damages`,
/// unless it is named there already, and takes out of it what could be saved. Returns the name of a
/// copy of the old file. Errors: corrupt, and nothing is changed, if not even the space can be
/// read; io.
[[nodiscard]] Result<std::string> salvage_file(const std::string& path,
                                               std::vector<Damage>& damages);

}  // namespace mneme::internal
