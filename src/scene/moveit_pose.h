// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Poses in MoveIt's messages, as lists of numbers or as maps from x, y, z, w. Quaternions are
/// x, y, z, w.
#pragma once

#include "mneme/geometry.h"
#include "scene/input.h"

namespace mneme::internal {

/// The keys `position` and `orientation`, which may be missing. Throws InputFailure.
[[nodiscard]] Transform read_moveit_pose(const Input& input);
/// The keys `translation` and `rotation`. Throws InputFailure.
[[nodiscard]] Transform read_moveit_transform(const Input& input);

}  // namespace mneme::internal
