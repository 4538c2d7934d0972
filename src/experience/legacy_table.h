// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Rows of an SQLite file of schema 1, which older versions wrote.
#pragma once

#include "experience/sqlite_connection.h"
#include "experience/store.h"

namespace mneme::internal {

/// The state that the file would have in the present schema.
[[nodiscard]] Result<StoreState> read_legacy_head(Connection& connection);

/// Visits the rows of `table` after the id `after` as rows of the present schema. A damaged one has
/// a flaw.
[[nodiscard]] Result<void> read_legacy_rows(Connection& connection, std::int64_t after,
                                            const RowVisitor& visit,
                                            const char* table = "experience");
[[nodiscard]] Result<void> read_legacy_rows_by_id(Connection& connection,
                                                  std::span<const std::int64_t> ids,
                                                  const RowVisitor& visit);

}  // namespace mneme::internal
