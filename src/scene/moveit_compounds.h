// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Meshes, planes and octomaps in MoveIt's messages.
#pragma once

#include "mneme/geometry.h"

#include "scene/input.h"

#include <optional>

namespace mneme::internal {

/// Of `vertices` and `triangles`. Throws InputFailure.
[[nodiscard]] Mesh read_moveit_mesh(const Input& mesh, const Transform& pose);
/// A box 200 m wide and 1 mm thick about a point of the plane a x + b y + c z + d = 0, whose normal
/// is the z axis of its pose. Throws InputFailure.
[[nodiscard]] Box read_moveit_plane(const Input& plane, const Transform& pose);
/// Nothing if the map has no data. Throws InputFailure.
[[nodiscard]] std::optional<Octree> read_moveit_octomap(const Input& octomap);

}  // namespace mneme::internal
