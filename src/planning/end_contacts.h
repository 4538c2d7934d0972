// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Contacts at the ends of a query.
#pragma once

#include "mneme/collision.h"

namespace mneme::internal {

/// True if nothing is close to `q`, a configuration of the robot. The kernels decide, because they
/// are what the planner sees; exact distances, which cost a thousand times more, have their say
/// close to contact.
[[nodiscard]] bool is_clear(const CollisionChecker& checker, const Configuration& q);

}  // namespace mneme::internal
