// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The functions of mneme/learning.h on a chain that was made once.
#pragma once

#include "mneme/memory.h"

#include "memory/planar_chain.h"

namespace mneme::internal {

[[nodiscard]] int first_crossing_link(const PlanarChain& chain, const PrimitiveKey& key,
                                      std::span<const double> q);
[[nodiscard]] std::optional<Configuration> sample_threaded(const CollisionChecker& checker,
                                                           const PlanarChain& chain,
                                                           const PrimitiveKey& key, int first_link,
                                                           int attempts, Rng& rng);

}  // namespace mneme::internal
