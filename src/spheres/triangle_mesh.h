// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Surfaces as triangles: what every solid is turned into before it is approximated.
#pragma once

#include "mneme/robot.h"

#include <vector>

namespace mneme::internal {

/// Triangles in any order; neighbours have corners at the very same coordinates.
using TriangleMesh = std::vector<Triangle>;

[[nodiscard]] TriangleMesh triangulate(const Box& box);
/// The cylinder lies in the prism that this is, and touches each of its sides.
[[nodiscard]] TriangleMesh triangulate(const Cylinder& cylinder);

/// True if every edge is shared by as many triangles in one direction as in the other, so that the
/// surface has no rim.
[[nodiscard]] bool is_closed(const TriangleMesh& mesh);

/// The same surface as triangles without an edge longer than `length`.
[[nodiscard]] TriangleMesh subdivide(const TriangleMesh& mesh, double length);

[[nodiscard]] double surface_area(const TriangleMesh& mesh);

/// The triangles of all solids of `link`, in its frame. Errors name the link, and the mesh file if
/// that is wrong (read_triangles()); solids that are not finite or have no surface.
[[nodiscard]] Result<TriangleMesh> link_surface(const Link& link);
/// The same of the meshes of an object, in files and among its shapes.
[[nodiscard]] Result<TriangleMesh> mesh_surface(const AttachedObject& object);

}  // namespace mneme::internal
