// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Shortcuts within a time limit.
#pragma once

#include "mneme/path.h"

#include <functional>

namespace mneme::internal {

class MotionVerifier;

struct ShortcutEffort {
  int attempts = 0;
  int patience = 0;      ///< so many attempts in vain, one after the other, end it
  float least_gain = 0;  ///< of the path's length; motions that gain less are not looked at
};

/// shortcut() that leaves the rest undone once `must_stop` says so; it is asked before each motion.
/// `verifier` may be null.
void shortcut_until(const CollisionChecker& checker, Path& path, std::uint64_t seed,
                    ShortcutEffort effort, const MotionVerifier* verifier, CheckCounters& counters,
                    const std::function<bool()>& must_stop);

}  // namespace mneme::internal
