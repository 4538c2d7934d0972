// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What is derived from a robot, made while it is loaded instead of in the first plan's time.
#pragma once

#include "mneme/collision.h"

namespace mneme::python {

/// A robot that cannot be checked says so when it is planned for.
inline void prepare(const Robot& robot) { static_cast<void>(CollisionChecker::make(robot, {})); }

}  // namespace mneme::python
