// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Databases as files for other programs.
#pragma once

#include "mneme/base.h"
#include "mneme/store.h"

#include <cstdint>
#include <string>

namespace mneme {

/// Writes all rows to a file in an order that depends on their content alone, so that equal sets
/// give equal bytes: JSON lines (`.jsonl`), or NumPy arrays (`.npz`). Returns their number.
/// docs/database.md describes both. Errors: invalid if the name ends otherwise; io.
[[nodiscard]] Result<std::int64_t> export_database(const std::string& url, const std::string& path);
/// Adds the rows of a file that export_database() or another program wrote, as merge_databases()
/// does. Errors: parse, naming line or array; wrong_robot; those of Database::open().
[[nodiscard]] Result<MergeSummary> import_database(const std::string& url, const std::string& path);

}  // namespace mneme
