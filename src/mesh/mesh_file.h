// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Reading of mesh files.
#pragma once

#include "mneme/base.h"
#include "mneme/geometry.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// Limits on the size of a file, on its number of triangles, and on that of vertices: as many as
/// triangles without a common vertex have.
inline constexpr std::size_t kMaxMeshBytes = std::size_t{256} << 20;
inline constexpr std::size_t kMaxTriangles = 1'000'000;
inline constexpr std::size_t kMaxVertices = 3 * kMaxTriangles;

/// Reads the triangles of an STL, OBJ, DAE or PLY file, binary or text, with all objects in place.
/// They are scaled along the axes of the mesh and then moved to `pose`. Triangles without area are
/// skipped. The unit of a DAE file is applied; its up axis is ignored, because robots have z up.
/// Files that the mesh refers to, such as materials, are not opened.
///
/// Errors name the file and mostly the line: not a regular file, unknown format, malformed, too
/// large, no triangles, or coordinates that are not finite or beyond 1 km. Time and memory are
/// bounded by the size of the file.
[[nodiscard]] Result<std::vector<Triangle>> read_triangles(const std::string& path,
                                                           const Vec3& scale,
                                                           const Transform& pose);
/// As read_triangles() for a file named `path` with these bytes.
[[nodiscard]] Result<std::vector<Triangle>> parse_triangles(std::string_view bytes,
                                                            const std::string& path,
                                                            const Vec3& scale,
                                                            const Transform& pose);

/// Returns whether a file is a well-formed mesh without a triangle that has an area, or has no
/// bytes. False for files beyond 64 kB, which are not read.
[[nodiscard]] bool is_empty_mesh(const std::string& path);

}  // namespace mneme::internal
