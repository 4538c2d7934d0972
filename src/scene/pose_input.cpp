// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/pose_input.h"

#include <cmath>

namespace mneme::internal {

Vec3 read_point(const Input& input) {
  const std::vector<double> p = input.finite_numbers(3, "x, y, z in metres");
  return {p[0], p[1], p[2]};
}

Eigen::Matrix3d read_rotation(const Input& input, bool is_scalar_first) {
  const std::vector<double> q = input.finite_numbers(
      4, is_scalar_first ? "a quaternion w, x, y, z" : "a quaternion x, y, z, w");
  return is_scalar_first ? rotation_of(input, {q[1], q[2], q[3], q[0]})
                         : rotation_of(input, {q[0], q[1], q[2], q[3]});
}

Eigen::Matrix3d rotation_of(const Input& input, const std::array<double, 4>& xyzw) {
  constexpr double kLeastNorm = 1e-6;
  const auto [x, y, z, w] = xyzw;
  if (std::hypot(std::hypot(x, y), std::hypot(z, w)) < kLeastNorm) {
    input.fail(ErrorCode::parse, "expected a quaternion that is not zero");
  }
  return rotation_from_quaternion(w, x, y, z);
}

}  // namespace mneme::internal
