// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Changing a store: every change is one transaction that leaves a head which fits the rows.
#pragma once

#include "store/store.h"

#include <span>

namespace mneme::internal {

/// Which of two rows with the same content stays.
enum class Duplicates {
  keep_first,     ///< the one that is there
  keep_earliest,  ///< the one with the smaller time, tool, settings, seed: the same in whatever
                  ///< order they come
};

struct Appended {
  std::vector<std::int64_t> ids;    ///< per row: its own, or that of the row with its content
  std::vector<bool> is_new;         ///< per row
  std::int64_t replaced_count = 0;  ///< rows that later ones took the place of
  StoreState before;                ///< what the rows were added to
  StoreState state;
};

/// Completes rows for storage. Errors: invalid, naming the row.
[[nodiscard]] Result<void> prepare_rows(std::vector<Experience>& rows,
                                        const RobotSignature& signature);

/// Appends all rows or none; what the store holds already is not added again. The rows must be
/// prepared.
[[nodiscard]] Result<Appended> append_rows(Store& store, std::span<const Experience> rows,
                                           Duplicates rule);

/// Says within a transaction, with the head that is locked, which rows to append; what else it
/// changes is committed with them, and undone if it fails.
using RowSource = std::function<Result<std::span<const Experience>>(const StoreState& head)>;
[[nodiscard]] Result<Appended> append_rows_of(Store& store, const RowSource& source,
                                              Duplicates rule);

/// A tombstone for `row`, which `state` counts from now on.
[[nodiscard]] Tombstone make_tombstone(StoreState& state, std::int64_t row, std::string reason);

/// Now, UTC, ISO 8601.
[[nodiscard]] std::string current_time();

}  // namespace mneme::internal
