// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The steps of Algorithm 2 for one kind of memory.
#pragma once

#include "pipeline/query.h"

#include <memory>
#include <span>
#include <variant>
#include <vector>

namespace mneme::internal {

/// Line 1: the primitives of the query, without matches yet.
[[nodiscard]] Result<std::vector<PrimitiveRetrieval>> decompose(const MemoryQuery& query,
                                                                const KindSettings& kind);

/// Lines 3 to 5: the stored samplers that are similar.
[[nodiscard]] Result<void> retrieve(const Database& database, const KindSettings& kind,
                                    PrimitiveRetrieval& primitive);

/// Lines 6 and 7: creates the sampler of a primitive that has no match, inserts it and retrieves
/// it, within the rest of the budget; adds the time to `learning_time_s`.
[[nodiscard]] Result<void> learn(const Query& query, const MemoryQuery& memory_query,
                                 const KindSettings& kind, PrimitiveRetrieval& primitive,
                                 double& learning_time_s);

/// What was retrieved: all components at once, or made when they are drawn.
using Recalled = std::variant<GaussianMixture, std::shared_ptr<const ComponentSource>>;

/// Line 10: one mixture of all that was retrieved. Sources are counted from `first_source`.
[[nodiscard]] Recalled synthesize(const MemoryQuery& query, const KindSettings& kind,
                                  std::span<const PrimitiveRetrieval> primitives,
                                  SampleSource first_source);

/// All components, made at once.
[[nodiscard]] GaussianMixture make_all(Recalled recalled, int joint_count);

/// Adds the components of another mixture to `all`, after those that it has.
void append(GaussianMixture& all, const GaussianMixture& more);

/// The components of `mixture` whose means are valid; all of them if none is, because a mean just
/// inside an obstacle still has free configurations around it.
[[nodiscard]] GaussianMixture keep_valid_components(const CollisionChecker& checker,
                                                    const GaussianMixture& mixture);

}  // namespace mneme::internal
