// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Points and rotations as lists of numbers.
#pragma once

#include "mneme/geometry.h"
#include "scene/input.h"

namespace mneme::internal {

/// Three finite numbers. Throws InputFailure.
[[nodiscard]] Vec3 read_point(const Input& input);
/// A quaternion that need not have unit length. Throws InputFailure.
[[nodiscard]] Eigen::Matrix3d read_rotation(const Input& input, bool is_scalar_first);
/// The rotation of x, y, z, w, which `input` has; it fails if they are all zero.
[[nodiscard]] Eigen::Matrix3d rotation_of(const Input& input, const std::array<double, 4>& xyzw);

}  // namespace mneme::internal
