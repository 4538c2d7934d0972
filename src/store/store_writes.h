// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Changes of a store, each in one transaction that also updates the head.
#pragma once

#include "store/store.h"

#include <span>

namespace mneme::internal {

/// Which of two rows with equal content is kept.
enum class Duplicates {
  keep_first,     ///< the stored one
  keep_earliest,  ///< the one with the smaller (time, tool, settings, seed), independent of
                  ///< insertion order
};

struct Appended {
  std::vector<std::int64_t> ids;    ///< per row: its own id, or the id of the stored row with equal
                                    ///< content
  std::vector<bool> is_new;         ///< per row
  std::int64_t replaced_count = 0;  ///< stored rows replaced by new ones
  StoreState before;                ///< state before the insertion
  StoreState state;
};

/// Checks rows and completes joint counts and times. Error: invalid, naming the row.
[[nodiscard]] Result<void> prepare_rows(std::vector<Experience>& rows,
                                        const RobotSignature& signature);

/// Appends all rows or none; skips rows whose content is already stored. The rows must have passed
/// prepare_rows().
[[nodiscard]] Result<Appended> append_rows(Store& store, std::span<const Experience> rows,
                                           Duplicates rule);

/// Chooses the rows to append, inside the transaction and with the head locked. Its own changes are
/// committed or rolled back with the rows.
using RowSource = std::function<Result<std::span<const Experience>>(const StoreState& head)>;
[[nodiscard]] Result<Appended> append_rows_of(Store& store, const RowSource& source,
                                              Duplicates rule);

/// Makes a tombstone for `row` and counts it in `state`.
[[nodiscard]] Tombstone make_tombstone(StoreState& state, std::int64_t row, std::string reason);

/// Current time, UTC, ISO 8601.
[[nodiscard]] std::string current_time();

}  // namespace mneme::internal
