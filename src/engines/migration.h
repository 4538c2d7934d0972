// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Migration from schema 3, which kept facts in provenance texts and keys, to schema 4.
#pragma once

#include "store/store.h"

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace mneme::internal {

/// The schema that this version can migrate.
inline constexpr int kOldSchema = 3;
/// The old columns in the order of read_row(), with constants for columns that the old schema
/// lacks.
inline constexpr std::string_view kOldColumns =
    "e.id, e.generation, e.cell, e.kind, e.content, e.components, 0, e.key, e.checksum, 0, "
    "m.means, "
    "m.factor_rows, m.factors, m.origins, 1, NULL, m.tool, m.settings, m.seed, m.time, m.checksum, "
    "m.id";

/// Converts the old robot row: robot_name, robot_hash, joint_count, checksum. Error: corrupt.
[[nodiscard]] Result<RobotSignature> upgraded_robot(const std::string& store, std::string_view name,
                                                    std::string_view hashes, int joint_count,
                                                    std::int64_t checksum);

/// Passes all old rows to its argument, in batches, in order of ids.
using OldRows =
    std::function<Result<void>(const std::function<Result<void>(std::span<const StoredRow>)>&)>;
/// Copies the live rows into `to`, under their ids. If rows become equal in the new schema, only
/// the first is copied. Damaged rows stay damaged. Dead rows and tombstones are dropped. `to`
/// has new tables, except for the old head and tombstones. Error: corrupt if rows are missing.
[[nodiscard]] Result<void> migrate_rows(const std::string& store, const OldRows& old_rows,
                                        StoreTransaction& to);

}  // namespace mneme::internal
