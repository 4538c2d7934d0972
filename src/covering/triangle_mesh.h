// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Surfaces as triangles: what every solid is turned into before it is covered.
#pragma once

#include "mneme/robot.h"

#include <array>
#include <vector>

namespace mneme::internal {

struct Triangle {
  Vec3 a = Vec3::Zero();
  Vec3 b = Vec3::Zero();
  Vec3 c = Vec3::Zero();

  [[nodiscard]] double area() const;
  [[nodiscard]] Vec3 centroid() const { return (a + b + c) / 3.0; }
};

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

/// Least and greatest coordinates; `mesh` has a triangle.
struct Bounds {
  Vec3 low;
  Vec3 high;
};
[[nodiscard]] Bounds bounds_of(const TriangleMesh& mesh);

/// Largest file and number of triangles that are read.
inline constexpr std::size_t kMaxMeshBytes = std::size_t{256} << 20;
inline constexpr std::size_t kMaxTriangles = 1'000'000;

/// Reads STL, OBJ or DAE, binary or text, all objects of the file in their places; the unit that a
/// DAE file states is honoured, its up axis is not, as robots are modelled with z up. Triangles
/// without area are left out. Errors name the file: not readable, of another format, malformed, too
/// large, without triangles, with coordinates that are not finite or beyond 1 km.
[[nodiscard]] Result<TriangleMesh> read_mesh(const MeshFile& file);

/// The triangles of all solids of `link`, in its frame. Errors name the link, and the mesh file if
/// that is wrong: see read_mesh; solids that are not finite or have no surface.
[[nodiscard]] Result<TriangleMesh> link_surface(const Link& link);

}  // namespace mneme::internal
