// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Shapes as scene files and compact files spell them.
#pragma once

#include "mneme/geometry.h"

#include "scene/input.h"

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// Keys of an obstacle besides those of its shape.
inline constexpr std::array<std::string_view, 2> kObstacleNaming{"name", "body"};

/// How the two kinds of files spell a pose.
struct ObstacleSpelling {
  std::string_view position;
  std::string_view quaternion;
  bool is_scalar_first = false;     ///< order of the quaternion
  bool writes_no_rotation = false;  ///< as a quaternion, instead of leaving it out
  std::span<const std::string_view> naming = kObstacleNaming;  ///< keys besides those of the shape
  bool may_name_files = true;                                  ///< of points, meshes and octrees
};
inline constexpr ObstacleSpelling kSceneSpelling{"position", "quat_xyzw", false, false};
inline constexpr ObstacleSpelling kCompactSpelling{"p", "q", true, true};
/// Of those who may not have files read.
inline constexpr ObstacleSpelling kRequestSpelling{"p", "q", true, true, kObstacleNaming, false};

/// Throws InputFailure if the shape of `input` is in a file and may not be.
void refuse_file(const Input& input, const ObstacleSpelling& spelling);

/// Three finite numbers. Throws InputFailure.
[[nodiscard]] Vec3 read_point(const Input& input);
/// A quaternion that need not have unit length. Throws InputFailure.
[[nodiscard]] Eigen::Matrix3d read_rotation(const Input& input, bool is_scalar_first);
/// The rotation of x, y, z, w, which `input` has; it fails if they are all zero.
[[nodiscard]] Eigen::Matrix3d rotation_of(const Input& input, const std::array<double, 4>& xyzw);

/// The shape of an obstacle that has the key `type` and may have those of `naming`. Throws
/// InputFailure, also for keys that its type does not have.
[[nodiscard]] Shape read_shape(const Input& input, const ObstacleSpelling& spelling,
                               std::vector<std::string>& warnings);

/// What describes a shape, besides its name: read_shape reads it back to the same.
struct ShapeField {
  std::string_view key;
  std::vector<double> values;
  bool is_list = false;  ///< otherwise there is one value
};
[[nodiscard]] std::vector<ShapeField> shape_fields(const Shape& shape,
                                                   const ObstacleSpelling& spelling);

/// The same in a scene file, without braces: "type: sphere, position: [0, 0, 1], radius: 0.1".
[[nodiscard]] std::string yaml_shape(const Shape& shape);

}  // namespace mneme::internal
