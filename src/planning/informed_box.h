// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Samples where a faster motion can be.
#pragma once

#include "mneme/path.h"
#include "mneme/planning.h"
#include "mneme/sampling.h"

#include <functional>
#include <memory>

namespace mneme::internal {

/// Returns a sampler that is uniform in a box that holds all motions from the start to a goal that
/// take less than `time_s` within `limits`. A joint that goes beyond an end has to come back. A
/// goal is chosen at random for each sample; goals that no motion reaches in that time do not
/// count, nor do those from where `is_over`, called before every goal, returns true. Null if there
/// are no others.
[[nodiscard]] std::unique_ptr<Sampler> make_informed_sampler(const Robot& robot,
                                                             const PlanQuery& ends,
                                                             const RateLimits& limits,
                                                             double time_s,
                                                             const std::function<bool()>& is_over);

}  // namespace mneme::internal
