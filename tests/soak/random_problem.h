// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Random problems whose start and goal are free by FCL.
#pragma once

#include "mneme/problem.h"

namespace mneme::soak {

/// Obstacles at random around the robot, such that neither start nor goal touches them: circles for
/// a planar robot, now and then two of them that leave a narrow gap; otherwise spheres, boxes,
/// cylinders and capsules within the reach of the arm. `margin` inflates the robot.
[[nodiscard]] Problem random_problem(const Robot& robot, double margin, Rng& rng);

/// Moves start and goal in random directions until they are at most `most` metres from contact with
/// an obstacle or another link, and free by FCL. An end that meets nothing on its way stays.
void bring_ends_close(Problem& problem, double most, Rng& rng);

}  // namespace mneme::soak
