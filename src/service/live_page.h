// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What the service shows at `/`.
#pragma once

#include "mneme/base.h"
#include "mneme/robot.h"
#include "mneme/service.h"

#include <string>

namespace mneme::internal {

/// The id of the scene that holds what the requests of the page cannot: obstacles of points,
/// triangles and cubes.
inline constexpr const char* kPageScene = "page";
/// That scene; empty if there is nothing of the kind to show.
[[nodiscard]] Scene scene_of_page(const ServiceSettings& settings);

/// The viewer with `settings.shown`, or with the robot at rest, as a page that asks the service for
/// plans. Errors: those of make_trace.
[[nodiscard]] Result<std::string> make_live_page(const Robot& robot, bool has_memory,
                                                 const ServiceSettings& settings);

}  // namespace mneme::internal
