// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mneme/pipeline.h"

namespace mneme::internal {

/// The settings with the robot's defaults for those that were left to it.
[[nodiscard]] SolveSettings complete_settings(SolveSettings settings, const Robot& robot);

}  // namespace mneme::internal
