// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mneme/ompl.h"

namespace mneme::ompl {

/// What `allocator` allocates, or the space's own samplers if it is empty, with each state that is
/// drawn counted.
[[nodiscard]] ::ompl::base::StateSamplerAllocator count_samples(
    ::ompl::base::StateSamplerAllocator allocator, std::shared_ptr<WorkCounters> counters);

}  // namespace mneme::ompl
