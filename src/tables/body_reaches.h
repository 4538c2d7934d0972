// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// How far joints can move bodies.
#pragma once

#include "tables/tables.h"

#include <span>

namespace mneme::internal {

/// On the straight motion between two configurations. A turning joint moves a point along an arc
/// about its axis, which is no farther from it than the links and slides between them are long.
[[nodiscard]] Reaches find_reaches(const RobotTables& tables, std::span<const float> from,
                                   std::span<const float> to);

/// Fills `reaches` and `has_far_slides` of tables that have all else.
void add_reaches(RobotTables& tables);

}  // namespace mneme::internal
