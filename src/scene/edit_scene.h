// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What edits and checkers ask of the shapes of an obstacle.
#pragma once

#include "mneme/scene.h"

namespace mneme::internal {

/// Errors: a shape with a flaw (find_flaw()); one with more points than check_point_count() allows.
[[nodiscard]] Result<void> check_shapes(const Obstacle& obstacle);

}  // namespace mneme::internal
