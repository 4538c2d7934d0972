// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/read_yaml.h"
#include "scene/scene_input.h"

#include <doctest/doctest.h>

namespace mneme::test {
namespace {

using internal::Input;

TEST_SUITE("unit") {
  TEST_CASE("a rotation is read in the order that is asked for") {
    const auto first = [](const Input& input) { return internal::read_rotation(input, true); };
    const auto last = [](const Input& input) { return internal::read_rotation(input, false); };
    const Eigen::Matrix3d about_z = rotation_about(Vec3::UnitZ(), 0.5 * 3.14159265358979);
    CHECK((read_yaml("[2, 0, 0, 2]", first).value() - about_z).norm() < 1e-12);
    CHECK((read_yaml("[0, 0, 1, 1]", last).value() - about_z).norm() < 1e-12);
    CHECK(failure_of("[0, 0, 0, 0]", last) == "f:1: expected a quaternion that is not zero");
    CHECK(failure_of("[0, 0, 0]", last) ==
          "f:1: expected 4 numbers (a quaternion x, y, z, w), got a list of 3");
  }

  TEST_CASE("a point has three finite numbers") {
    CHECK(read_yaml("[1, -2, .5]", internal::read_point).value() == Vec3(1, -2, 0.5));
    CHECK(failure_of("[1, 2, .nan]", internal::read_point).find("f:1: ") == 0);
  }
}

}  // namespace
}  // namespace mneme::test
