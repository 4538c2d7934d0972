// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Surfaces as triangles: every solid becomes one before it is approximated.
#pragma once

#include "mneme/robot.h"

#include <vector>

namespace mneme::internal {

/// Triangles in any order; neighbours have corners at the very same coordinates.
using TriangleMesh = std::vector<Triangle>;

[[nodiscard]] TriangleMesh triangulate(const Box& box);
/// Returns a prism that contains the cylinder and touches it with each side.
[[nodiscard]] TriangleMesh triangulate(const Cylinder& cylinder);

/// Returns the same surface as triangles with edges of at most `length`.
[[nodiscard]] TriangleMesh subdivide(const TriangleMesh& mesh, double length);

[[nodiscard]] double surface_area(const TriangleMesh& mesh);

/// Returns the triangles of all solids of `link`, in its frame. Errors name the link: a mesh file
/// that cannot be used (also named), solids that are not finite or have no surface.
[[nodiscard]] Result<TriangleMesh> link_surface(const Link& link);
/// Returns the triangles of the meshes of an object, in files and among its shapes. Errors: as
/// link_surface().
[[nodiscard]] Result<TriangleMesh> mesh_surface(const AttachedObject& object);

}  // namespace mneme::internal
