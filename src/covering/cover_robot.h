// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// All links of a robot covered, from the cache where possible.
#pragma once

#include "mneme/covering.h"

#include "covering/cover_cache.h"

namespace mneme::internal {

struct CachedCovering {
  Covering covering;
  int found = 0;   ///< covers that were in the cache
  int stored = 0;  ///< covers that were made and are in the cache now
};

/// cover_robot with a cache.
[[nodiscard]] Result<CachedCovering> cover_robot(Robot::Parts parts, const CoverSettings& settings,
                                                 const CoverCache& cache);

}  // namespace mneme::internal
