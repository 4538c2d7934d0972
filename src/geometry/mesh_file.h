// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Meshes in files.
#pragma once

#include "mneme/base.h"
#include "mneme/geometry.h"

#include <cstddef>
#include <string>
#include <vector>

namespace mneme::internal {

/// Largest file and number of triangles that are read.
inline constexpr std::size_t kMaxMeshBytes = std::size_t{256} << 20;
inline constexpr std::size_t kMaxTriangles = 1'000'000;

/// Reads STL, OBJ, DAE or PLY, binary or text, all objects of the file in their places, scaled
/// along the axes of the mesh and moved to `pose`; the unit that a DAE file states is honoured, its
/// up axis is not, as robots are modelled with z up. Triangles without area are left out. Errors
/// name the file: not readable, of another format, malformed, too large, without triangles, with
/// coordinates that are not finite or beyond 1 km.
[[nodiscard]] Result<std::vector<Triangle>> read_triangles(const std::string& path,
                                                           const Vec3& scale,
                                                           const Transform& pose);

}  // namespace mneme::internal
