// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Algorithm 2, line 10, for pairs of circles: means that are fitted to the query's own gaps, each
/// when it is first drawn.
#pragma once

#include "mneme/memory.h"

#include <memory>
#include <span>

namespace mneme::internal {

/// MemoryKind::retarget of the kind "pairs". A match is a group. Pairs that start or a goal cross
/// come first: the best match of each of them takes part from the first draw on; then those of the
/// others, then the second best ones, and so on. Means that are deeper in a gap than start and
/// goals are have nothing to say, nor have those that GapFit or the joint limits refuse. Null for
/// an arm that is no PlanarChain.
[[nodiscard]] std::shared_ptr<const ComponentSource> retarget_means(
    const MemoryQuery& query, std::span<const PrimitiveRetrieval> primitives,
    SampleSource first_source);

}  // namespace mneme::internal
