// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What the service shows at `/`.
#pragma once

#include "mneme/base.h"
#include "mneme/robot.h"
#include "mneme/service.h"

#include <string>

namespace mneme::internal {

/// The viewer with `settings.shown`, or with the robot at rest, as a page that asks the service for
/// plans. Errors: those of make_trace.
[[nodiscard]] Result<std::string> make_live_page(const Robot& robot, bool has_memory,
                                                 const ServiceSettings& settings);

}  // namespace mneme::internal
