// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/moveit_pose.h"

#include "scene/pose_input.h"

namespace mneme::internal {
namespace {

Vec3 read_vector(const Input& input) {
  if (!input.is_map()) {
    return read_point(input);
  }
  input.allow_keys({"x", "y", "z"});
  return {input.at("x").finite_number(), input.at("y").finite_number(),
          input.at("z").finite_number()};
}

Eigen::Matrix3d read_quaternion(const Input& input) {
  if (!input.is_map()) {
    return read_rotation(input, false);
  }
  input.allow_keys({"x", "y", "z", "w"});
  return rotation_of(input, {input.at("x").finite_number(), input.at("y").finite_number(),
                             input.at("z").finite_number(), input.at("w").finite_number()});
}

Transform read(const Input& input, std::string_view vector, std::string_view quaternion) {
  input.allow_keys({vector, quaternion});
  Transform X;
  X.translation = read_vector(input.at(vector));
  if (const auto rotation = input.find(quaternion)) {
    X.rotation = read_quaternion(*rotation);
  }
  return X;
}

}  // namespace

Transform read_moveit_pose(const Input& input) { return read(input, "position", "orientation"); }

Transform read_moveit_transform(const Input& input) {
  return read(input, "translation", "rotation");
}

}  // namespace mneme::internal
