// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Capsules around surfaces that are nearly capsules, and of cylinders with round ends.
#pragma once

#include "mneme/robot.h"

#include "spheres/approximate_solid.h"

#include <optional>

namespace mneme::internal {

struct FittedCapsule {
  Capsule capsule;
  Excess excess;
};

/// Returns a capsule that contains the mesh and what it encloses, and sticks out by at most `most`
/// metres and half of that in the mean. Nothing if there is none along the longest principal axis.
[[nodiscard]] std::optional<FittedCapsule> fit_capsule(const TriangleMesh& mesh,
                                                       const SolidModel& solid, double most);

/// Replaces each cylinder whose flat ends are the middles of two of the link's spheres, of the same
/// radius, by a capsule. URDF has no capsules, so robots describe them by these three shapes.
void join_capsules(Link& link);

}  // namespace mneme::internal
