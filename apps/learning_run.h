// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Learning with progress, as `mneme learn` and `mneme demo` do it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mneme/learning.h"

namespace mneme::app {

/// The keys that `database` held when the job of `seed` first inserted one, so that a job that is
/// run again covers the grid in the same way.
[[nodiscard]] std::vector<PrimitiveKey> keys_before(const Database& database, std::uint64_t seed);

/// Learns `keys` with progress on standard error until it is done or interrupted.
[[nodiscard]] Result<LearnSummary> learn_with_progress(const Robot& robot,
                                                       std::span<const PrimitiveKey> keys,
                                                       Database& database, LearnJob job);

/// How well a database covers a grid, measured on random primitives of its range.
struct Coverage {
  int samples = 0;
  double matched = 0;  ///< fraction with a match under the grid's largest similarity error
  double p50 = 0, p95 = 0, max = 0;  ///< similarity error of the nearest match, m^2
};
/// The database must not be empty.
[[nodiscard]] Coverage measure_coverage(const Database& database, const PrimitiveGrid& grid);

}  // namespace mneme::app
