// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What files and callers say that all of a path must keep.
#pragma once

#include "mneme/problem.h"

#include "scene/input.h"

namespace mneme::internal {

/// Adds those of the key `constraints`, whose directions `up` are in a frame whose pose is `X_RF`.
/// Throws InputFailure.
void read_constraints(const Input& problem_input, const Transform& X_RF, Problem& problem);
/// Adds those that `options` say. Throws InputFailure.
void take_constraints(const ProblemOptions& options, const Transform& X_RF, Problem& problem);
/// Adds one, in the root link's frame. Throws InputFailure at `place` if the robot cannot keep it.
void add_constraint(const Input& place, OrientationConstraint constraint, Problem& problem);

}  // namespace mneme::internal
