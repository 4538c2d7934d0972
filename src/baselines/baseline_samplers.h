// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What the same memory is worth without local retrieval: samplers to compare Algorithm 2 with.
#pragma once

#include "pipeline/query.h"

namespace mneme::internal {

/// All components of the database, where they were learned: canonical, moved by no symmetry.
[[nodiscard]] Result<GaussianMixture> pool_all(const Query& query, const MemoryQuery& asked);

/// The components of the rows whose primitive resembles the scene as a whole: as many rows as
/// retrieval per primitive may find. Scene and primitive are sets of circles, brought to canonical
/// form by the direction of their mean centre; the distance of two sets is the mean squared
/// distance of a circle to the nearest of the other set, both ways. Errors: those of decompose(); a
/// memory that has no pairs of circles.
[[nodiscard]] Result<GaussianMixture> recall_nearest_scenes(const Query& query,
                                                            const MemoryQuery& asked);

/// The distance of two sets of circles (x, y, radius), m^2.
[[nodiscard]] double scene_distance(const PrimitiveKey& a, const PrimitiveKey& b);

}  // namespace mneme::internal
