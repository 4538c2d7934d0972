// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Shortcuts within a time limit.
#pragma once

#include <functional>

#include "mneme/planning.h"

namespace mneme::internal {

/// shortcut() that leaves the rest undone once `must_stop` says so; it is asked before each motion.
void shortcut_until(const CollisionChecker& checker, Path& path, std::uint64_t seed, int attempts,
                    bool verify, CheckCounters& counters, const std::function<bool()>& must_stop);

}  // namespace mneme::internal
