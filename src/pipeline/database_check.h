// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mneme/pipeline.h"

namespace mneme::internal {

/// wrong_robot unless `database` holds experience of `robot`; invalid if there is no such
/// decomposer. A database that
/// was opened to look at it may be of any space, or of none if it is empty.
[[nodiscard]] Result<void> check_database(const Robot& robot, const SolveSettings& settings,
                                          const Database& database);

}  // namespace mneme::internal
