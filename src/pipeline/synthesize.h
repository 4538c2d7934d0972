// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "mneme/pipeline.h"

namespace mneme::internal {

/// Algorithm 2, line 10: pools the components of all matches, each moved to the scene by its
/// symmetry, equally likely; that is what a_i = M_i / N says. Components count for the primitive
/// that they were retrieved for, and stand in order of relevance: the most similar match first.
/// Those that a symmetry moves outside the joint limits are dropped.
[[nodiscard]] GaussianMixture synthesize(const Robot& robot,
                                         std::span<const PrimitiveRetrieval> primitives);

}  // namespace mneme::internal
