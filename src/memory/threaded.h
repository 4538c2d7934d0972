// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The functions of mneme/learning.h on a chain that was made once.
#pragma once

#include "mneme/memory.h"

#include "memory/planar_chain.h"

namespace mneme::internal {

/// The first link that crosses the segment between the two circles, or -1: then the arm is out.
[[nodiscard]] int first_crossing_link(const PlanarChain& chain, const PrimitiveKey& key,
                                      std::span<const double> q);
/// A random configuration, free of contact, whose first link through the gap of the circles is
/// `first_link`. Nothing if none was found in `attempts` tries.
[[nodiscard]] std::optional<Configuration> sample_threaded(const CollisionChecker& checker,
                                                           const PlanarChain& chain,
                                                           const PrimitiveKey& key, int first_link,
                                                           int attempts, Rng& rng);

}  // namespace mneme::internal
