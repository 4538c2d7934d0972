// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Mesh files as triangles in a link's frame.
#pragma once

#include "covering/triangle_mesh.h"

namespace mneme::internal {

/// Largest file and number of triangles that are read.
inline constexpr std::size_t kMaxMeshBytes = std::size_t{256} << 20;
inline constexpr std::size_t kMaxTriangles = 1'000'000;

/// Reads STL, OBJ or DAE, binary or text, all objects of the file in their places; the unit that a
/// DAE file states is honoured, its up axis is not, as robots are modelled with z up. Triangles
/// without area are left out. Errors name the file: not readable, of another format, malformed, too
/// large, without triangles, with coordinates that are not finite or beyond 1 km.
[[nodiscard]] Result<TriangleMesh> read_mesh(const MeshFile& file);

}  // namespace mneme::internal
