// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Whether a robot lives in the plane z = 0.
#pragma once

#include <span>

#include "mneme/robot.h"

namespace mneme::internal {

/// True if all joints of the group, and all that follow them, turn about the z axis of a frame
/// whose z axis is parallel to the root's, and all shapes are centred in z = 0; to within 1e-9. It
/// is enough to look at one configuration, since such joints keep z.
[[nodiscard]] bool moves_in_plane(std::span<const Link> links, std::span<const Joint> joints,
                                  std::span<const int> group);

}  // namespace mneme::internal
