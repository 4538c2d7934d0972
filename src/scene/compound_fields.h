// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Points, meshes and octrees of scene files: in files of their own, or as lists of numbers.
#pragma once

#include "mneme/geometry.h"

#include "scene/input.h"

#include <string>
#include <vector>

namespace mneme::internal {

/// The shape without its pose and radius: either the key `file` (of octrees also `unknown`) or the
/// list `points`, `triangles` or `cubes`, and `scale` but of octrees. Throws InputFailure. Adds
/// warnings to `warnings`.
[[nodiscard]] PointCloud read_points(const Input& input, std::vector<std::string>& warnings);
[[nodiscard]] Mesh read_mesh_shape(const Input& input, std::vector<std::string>& warnings);
[[nodiscard]] Octree read_octree_shape(const Input& input);

/// All numbers of the list.
[[nodiscard]] std::vector<double> numbers_of(const Parts<CloudPoint>& parts);
[[nodiscard]] std::vector<double> numbers_of(const Parts<Triangle>& parts);
[[nodiscard]] std::vector<double> numbers_of(const Parts<Cube>& parts);

}  // namespace mneme::internal
