// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mneme/memory.h"

#include <functional>

namespace mneme::internal {

/// Merges as mneme/learning.h says until `is_late`; what is left then stays as it is.
[[nodiscard]] LocalSampler merge_cliques(const CollisionChecker& checker,
                                         const LocalSampler& sampler,
                                         const std::function<bool()>& is_late);

}  // namespace mneme::internal
