// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Reading and appending rows, and the tally that tells whether all of them are there.
#pragma once

#include "mneme/experience.h"
#include "experience/row_codec.h"
#include "experience/sqlite_connection.h"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace mneme::internal {

/// A row as it stands in the file, sound or not.
struct StoredRow {
  std::int64_t id = 0;
  std::int64_t checksum = 0;
  RowView content;
};

/// Calls `visit` with each row in order of ids until it returns an error. Then compares number and
/// checksums of the rows with the tally: a row that vanished, came or changed its id is `corrupt`.
/// Wants a transaction around it if others may write.
[[nodiscard]] Result<void> read_rows(Connection& connection,
                                     const std::function<Result<void>(const StoredRow&)>& visit);

/// Appends all rows or none, in a transaction of its own; returns their ids. The rows must be
/// sound.
[[nodiscard]] Result<std::vector<std::int64_t>> append_rows(Connection& connection,
                                                            std::span<const Experience> rows);

}  // namespace mneme::internal
