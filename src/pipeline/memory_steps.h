// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The steps of Algorithm 2 for one kind of memory.
#pragma once

#include "pipeline/query.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace mneme::internal {

/// Line 1: returns the primitives of the query, without matches.
[[nodiscard]] Result<std::vector<PrimitiveRetrieval>> decompose(const MemoryQuery& query,
                                                                const KindSettings& kind);

/// Lines 3 to 5: retrieves the similar samplers of a primitive.
[[nodiscard]] Result<void> retrieve(const Database& database, const KindSettings& kind,
                                    PrimitiveRetrieval& primitive);

/// Lines 6 and 7: learns the sampler of a primitive without a match, inserts and retrieves it,
/// within the rest of the budget. Adds the time to `learning_time_s`.
[[nodiscard]] Result<void> learn(const Query& query, const MemoryQuery& memory_query,
                                 const KindSettings& kind, PrimitiveRetrieval& primitive,
                                 double& learning_time_s);

/// The provenance of a row that this version of mneme makes. `settings` is for people.
[[nodiscard]] Provenance provenance_of(std::string settings, std::uint64_t seed);

/// Returns one row, for insertion.
[[nodiscard]] std::vector<Experience> new_row(std::string_view kind, PrimitiveKey key,
                                              decltype(Experience::content) content,
                                              Provenance provenance);

/// Retrieved components: all at once, or made when they are sampled.
using Recalled = std::variant<GaussianMixture, std::shared_ptr<const ComponentSource>>;

/// Line 10: combines all retrieved samplers. Sources are numbered from `first_source`.
[[nodiscard]] Recalled synthesize(const MemoryQuery& query, const KindSettings& kind,
                                  std::span<const PrimitiveRetrieval> primitives,
                                  SampleSource first_source);

/// Appends the components of `more` to `all`.
void append(GaussianMixture& all, const GaussianMixture& more);

/// Returns the components of `mixture` whose means are valid, or all of them if none is: a mean
/// just inside an obstacle still has free configurations around it.
[[nodiscard]] GaussianMixture keep_valid_components(const CollisionChecker& checker,
                                                    const GaussianMixture& mixture);

}  // namespace mneme::internal
