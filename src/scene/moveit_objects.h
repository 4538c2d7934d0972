// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Collision objects in MoveIt's messages.
#pragma once

#include <string>
#include <vector>

#include "mneme/scene.h"
#include "scene/input.h"

namespace mneme::internal {

struct MoveitObject {
  Obstacle obstacle;  ///< in `frame`
  std::string frame;
  Input place;
};

/// The list `collision_objects` of `world`. Throws InputFailure; what is no box, sphere or cylinder
/// is refused by name.
[[nodiscard]] std::vector<MoveitObject> read_moveit_objects(const Input& world);

}  // namespace mneme::internal
