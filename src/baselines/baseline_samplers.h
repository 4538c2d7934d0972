// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Samplers that use a whole database without local retrieval, for comparison with Algorithm 2.
#pragma once

#include "pipeline/query.h"

namespace mneme::internal {

/// All components of the database, in canonical pose, without any symmetry applied.
[[nodiscard]] Result<GaussianMixture> pool_all(const Query& query, const MemoryQuery& request);

/// The components of the rows whose primitives are most similar to the whole scene, at most as many
/// rows as retrieval per primitive may find. Scene and primitive are sets of circles, turned by the
/// direction of their mean centre to canonical form and compared by scene_distance(). Errors: those
/// of decompose(); a database without pairs of circles.
[[nodiscard]] Result<GaussianMixture> recall_nearest_scenes(const Query& query,
                                                            const MemoryQuery& request);

/// The mean squared distance of a circle (x, y, radius) to the nearest one of the other set, in
/// both directions, m^2.
[[nodiscard]] double scene_distance(const PrimitiveKey& a, const PrimitiveKey& b);

}  // namespace mneme::internal
