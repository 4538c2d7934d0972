// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Paths that keep away from obstacles.
#pragma once

#include "mneme/path.h"

namespace mneme::internal {

/// `path` off what it touches, where a few rounds of pushing lead it there, as few waypoints as
/// keep it so: its states are free then, its motions are not verified. Its ends stay. Empty if
/// something still touches.
[[nodiscard]] Path push_off(const CollisionChecker& checker, const Path& path,
                            CheckCounters& counters);

/// A path like `path`, which is free, that stays free while obstacles are moved a little: 2 to 3 cm
/// away from them where there is room, and at most 15 % longer. `path` itself if that one does not
/// pass verification, or once `settings` cancel it.
[[nodiscard]] Path widen(const CollisionChecker& checker, const Path& path,
                         const FinishSettings& settings);

}  // namespace mneme::internal
