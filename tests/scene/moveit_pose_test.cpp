// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/moveit_messages.h"
#include "scene/read_yaml.h"

#include <doctest/doctest.h>

namespace mneme::test {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("lists and maps say the same pose") {
    const Transform list =
        read_yaml("{position: [1, 2, 3], orientation: [0, 0, 1, 1]}", internal::read_moveit_pose)
            .value();
    const Transform map = read_yaml(
                              "{position: {x: 1, y: 2, z: 3}, orientation: {w: 1, x: 0, y: 0, "
                              "z: 1}}",
                              internal::read_moveit_pose)
                              .value();
    CHECK((list * Vec3(1, 0, 0) - Vec3(1, 3, 3)).norm() < 1e-12);
    CHECK(list.rotation == map.rotation);
    CHECK(list.translation == map.translation);
    CHECK((read_yaml("{translation: [1, 2, 3], rotation: [0, 0, 1, 1]}",
                     internal::read_moveit_transform)
               .value()
               .rotation == list.rotation));
  }

  TEST_CASE("a missing orientation is none, anything else that is missing is refused") {
    const auto read = internal::read_moveit_pose;
    CHECK(read_yaml("{position: [1, 2, 3]}", read).value().rotation == Eigen::Matrix3d::Identity());
    CHECK(failure_of("{orientation: [0, 0, 0, 1]}", read) ==
          "f:1: expected the key position, which is missing");
    CHECK(failure_of("{position: {x: 1, y: 2}}", read) ==
          "f:1: key position: expected the key z, which is missing");
    CHECK(failure_of("{position: [0, 0, 0], orientation: {x: 0, y: 0, z: 0, w: 0}}", read) ==
          "f:1: key orientation: expected a quaternion that is not zero");
    CHECK(failure_of("{position: [0, 0, 0], rpy: [0, 0, 0]}", read) ==
          "f:1: key rpy: unknown key, expected one of position, orientation");
  }
}

}  // namespace
}  // namespace mneme::test
