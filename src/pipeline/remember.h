// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Memory that grows with use.
#pragma once

#include "mneme/pipeline.h"

namespace mneme::internal {

/// Inserts what the path of a solved problem teaches, if `remember_after` asks for it. The settings
/// are complete.
[[nodiscard]] Remembered remember(const Problem& problem, const PlanResult& plan,
                                  Database& database, const SolveSettings& settings);

}  // namespace mneme::internal
