// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Maintenance of a store's rows: list, visit, set aside, compact, merge.
#pragma once

#include "store/store.h"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace mneme::internal {

/// A live row without its content.
struct LiveRow {
  ContentHash content{};
  std::int64_t id = 0;
};
/// All live rows in order of their content hashes, which is independent of insertion order.
[[nodiscard]] Result<std::vector<LiveRow>> list_by_content(Store& store);

using RowsVisitor = std::function<Result<void>(std::span<const Experience>)>;
/// Passes the rows of `list` to `visit` in that order, some hundred at a time. Error: corrupt,
/// naming a damaged or missing row.
[[nodiscard]] Result<void> visit_rows(Store& store, const RobotSignature& signature,
                                      std::span<const LiveRow> list, const RowsVisitor& visit);

/// Sets the rows of `damages` aside, deletes damaged tombstones, and writes a head that matches the
/// remaining rows.
[[nodiscard]] Result<void> quarantine_rows(Store& store, std::span<const Damage> damages,
                                           std::span<const std::int64_t> damaged_tombstones = {});

/// Deletes dead rows and frees their space. Returns their number.
[[nodiscard]] Result<std::int64_t> compact_store(Store& store);

/// Adds rows that `target` lacks, in one transaction, and counts them. The rows must be sound.
[[nodiscard]] Result<void> merge_rows(Store& target, std::span<const Experience> rows,
                                      MergeSummary& summary);
/// Adds the records of finished lessons of `source`, so that merged lessons are not learned again.
[[nodiscard]] Result<void> merge_lessons(Store& target, Store& source);

}  // namespace mneme::internal
