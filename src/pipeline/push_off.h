// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Paths that keep away from obstacles.
#pragma once

#include "mneme/path.h"

#include <functional>

namespace mneme::internal {

/// `path` with a waypoint every 0.15 radians; those whose way from the start `is_wanted` are pushed
/// off obstacles, to `clearance` metres where that goes. Its ends stay. Nothing of it is checked.
[[nodiscard]] Path push_off(const CollisionChecker& checker, const Path& path, double clearance,
                            const std::function<bool(float way)>& is_wanted);

/// A path like `path`, which is free, that stays free while obstacles are moved a little: 2 cm away
/// from them where there is room. `path` itself if that one would be much longer or not pass.
[[nodiscard]] Path widen(const CollisionChecker& checker, const Path& path, std::uint64_t seed);

}  // namespace mneme::internal
