// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mneme/pipeline.h"

namespace mneme::internal {

/// The settings with the defaults of the robot, and of the decomposer that made the database, for
/// those that were left to them. `database` may be null.
[[nodiscard]] SolveSettings complete_settings(SolveSettings settings, const Robot& robot,
                                              const Database* database = nullptr);

}  // namespace mneme::internal
