// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Moves paths away from obstacles.
#pragma once

#include "mneme/path.h"

namespace mneme::internal {

/// Pushes `path` out of contact within a few rounds, and drops waypoints that are not needed then.
/// States of the result are free; its motions are not verified. Keeps the ends. Empty if contact
/// remains.
[[nodiscard]] Path push_off(const CollisionChecker& checker, const Path& path,
                            CheckCounters& counters);

/// Returns a path similar to `path` that also stays free if obstacles move a little: 2 to 3 cm away
/// from them where there is room, and at most 15 % longer. `path` must be free. Returns `path` if
/// the result does not pass verification, or if `settings` cancel it.
[[nodiscard]] Path widen(const CollisionChecker& checker, const Path& path,
                         const FinishSettings& settings);

}  // namespace mneme::internal
