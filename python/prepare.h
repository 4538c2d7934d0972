// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Fills the caches of a robot when it is loaded, so that its first plan is fast.
#pragma once

#include "mneme/collision.h"

namespace mneme::python {

/// Ignores errors, which planning reports.
inline void prepare(const Robot& robot) { static_cast<void>(CollisionChecker::make(robot, {})); }

}  // namespace mneme::python
