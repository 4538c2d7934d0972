// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mneme/ompl.h"

namespace mneme::ompl {

/// Motions are valid if they pass the verification of final paths. Refers to `verifier`.
[[nodiscard]] ::ompl::base::MotionValidatorPtr make_verified_motion_validity(
    const ::ompl::base::SpaceInformationPtr& information, const CollisionChecker& checker,
    std::shared_ptr<WorkCounters> counters, const MotionVerifier& verifier);

}  // namespace mneme::ompl
