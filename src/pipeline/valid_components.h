// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mneme/collision.h"
#include "mneme/sampling.h"

namespace mneme::internal {

/// The components of `mixture` whose means are valid; all of them if none is, because a mean just
/// inside an obstacle still has free configurations around it.
[[nodiscard]] GaussianMixture keep_valid_components(const CollisionChecker& checker,
                                                    const GaussianMixture& mixture);

}  // namespace mneme::internal
