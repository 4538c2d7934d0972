// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// From schema 3, which kept facts in the texts of provenances and in keys, to schema 4.
#pragma once

#include "store/store.h"

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace mneme::internal {

/// The schema that this version brings up to its own.
inline constexpr int kOldSchema = 3;
/// The columns of its rows for read_row(), with what it kept elsewhere in their places.
inline constexpr std::string_view kOldColumns =
    "e.id, e.generation, e.cell, e.kind, e.content, e.components, 0, e.key, e.checksum, 0, "
    "m.means, "
    "m.factor_rows, m.factors, m.origins, 1, NULL, m.tool, m.settings, m.seed, m.time, m.checksum, "
    "m.id";

/// Its row that names the robot: robot_name, robot_hash, joint_count, checksum. Error: corrupt.
[[nodiscard]] Result<RobotSignature> upgraded_robot(const std::string& store, std::string_view name,
                                                    std::string_view hashes, int joint_count,
                                                    std::int64_t checksum);

/// Hands all old rows to its argument, some at a time, in order of ids.
using OldRows =
    std::function<Result<void>(const std::function<Result<void>(std::span<const StoredRow>)>&)>;
/// Writes the live rows into `to`, whose tables are new except for its head and tombstones, under
/// their ids; of those that are the same experience by now, the first. Damaged rows stay damaged.
/// Dead ones and tombstones are left behind. Error: corrupt if rows are missing.
[[nodiscard]] Result<void> migrate_rows(const std::string& store, const OldRows& old_rows,
                                        StoreTransaction& to);

}  // namespace mneme::internal
