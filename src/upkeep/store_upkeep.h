// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What upkeep does with the rows of a store: all of them in order, set aside, removed, merged.
#pragma once

#include "store/store.h"

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace mneme::internal {

/// A live row without its content.
struct LiveRow {
  ContentHash content{};
  std::int64_t id = 0;
};
/// All live rows in order of their content hashes, which does not depend on how they came to be
/// there.
[[nodiscard]] Result<std::vector<LiveRow>> list_by_content(Store& store);

using RowsVisitor = std::function<Result<void>(std::span<const Experience>)>;
/// Hands the rows that `list` names to `visit` in its order, some hundred at a time. Errors:
/// corrupt, naming the row, if one is damaged or missing.
[[nodiscard]] Result<void> visit_rows(Store& store, const RobotSignature& signature,
                                      std::span<const LiveRow> list, const RowsVisitor& visit);

/// Sets the rows of `damages` aside, removes tombstones that are damaged, and writes a head that
/// fits what is there, whatever it was.
[[nodiscard]] Result<void> quarantine_rows(Store& store, std::span<const Damage> damages,
                                           std::span<const std::int64_t> damaged_tombstones = {});

/// Removes dead rows for good, and gives back their space. Returns their number.
[[nodiscard]] Result<std::int64_t> compact_store(Store& store);

/// The epoch after that of `old_head`; without one (null), one that was certainly never in use.
[[nodiscard]] std::int64_t next_epoch(const StoreState* old_head);

/// Adds rows that `target` does not have, in one transaction, and counts them. The rows must be
/// sound.
[[nodiscard]] Result<void> merge_rows(Store& target, std::span<const Experience> rows,
                                      MergeSummary& summary);

}  // namespace mneme::internal
