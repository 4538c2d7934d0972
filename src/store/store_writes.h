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
  keep_earliest,  ///< the one with the smaller time, then tool: the same in whatever order they
                  ///< come
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
                                        const ExperienceSpace& space);

/// Appends all rows or none; what the store holds already is not added again. The rows must be
/// prepared.
[[nodiscard]] Result<Appended> append_rows(Store& store, std::span<const Experience> rows,
                                           Duplicates rule);

/// Says within a transaction, with the head that is locked, which rows to append; what else it
/// changes is committed with them, and undone if it fails.
using RowSource = std::function<Result<std::span<const Experience>>(const StoreState& head)>;
[[nodiscard]] Result<Appended> append_rows_of(Store& store, const RowSource& source,
                                              Duplicates rule);

/// A row to set aside, and why.
struct Burial {
  std::int64_t row = 0;
  std::string reason;
};
/// Buries rows, removes tombstones that are damaged, and writes a head that fits what is there,
/// whatever it was.
[[nodiscard]] Result<void> quarantine_rows(Store& store, std::span<const Burial> burials,
                                           std::span<const std::int64_t> damaged_tombstones = {});

/// Removes dead rows for good, and gives back their space. Returns their number.
[[nodiscard]] Result<std::int64_t> compact_store(Store& store);

/// Now, UTC, ISO 8601.
[[nodiscard]] std::string current_time();

/// The epoch after that of `old_head`; without one (null), one that was certainly never in use.
[[nodiscard]] std::int64_t next_epoch(const StoreState* old_head);

/// Adds rows that `target` does not have, in one transaction, and counts them. The rows must be
/// sound.
[[nodiscard]] Result<void> merge_rows(Store& target, std::span<const Experience> rows,
                                      MergeSummary& summary);

}  // namespace mneme::internal
