// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/small_robots.h"
#include "robot/write_robot.h"
#include "support/support.h"

#include <string>

namespace mneme {
namespace {

using internal::xml_escaped;
using internal::xml_origin;
using internal::xml_vector;
using test::kPi;

/// The pose that an origin reads back to.
Transform reread(const Transform& pose) {
  const auto parts = parse_robot_parts(
      R"(<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="fixed">)"
      R"(<parent link="a"/><child link="b"/>)" +
          xml_origin(pose) + "</joint></robot>",
      "r.urdf");
  REQUIRE(parts.has_value());
  return parts->joints[0].origin;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("characters that XML reserves are escaped") {
    CHECK(xml_escaped("a<b>&\"c'") == "a&lt;b>&amp;&quot;c'");
  }

  TEST_CASE("vectors keep all digits and no negative zero") {
    CHECK(xml_vector(Vec3(0.1, -0.0, 1.0 / 3)) == "0.1 0 0.3333333333333333");
  }

  TEST_CASE("an origin has only what is not zero") {
    CHECK(xml_origin({}).empty());
    CHECK(xml_origin({Eigen::Matrix3d::Identity(), Vec3(0, 0, 1)}) == R"(<origin xyz="0 0 1"/>)");
    CHECK(xml_origin({rotation_about(Vec3::UnitX(), 0.5), Vec3::Zero()}) ==
          R"(<origin rpy="0.5 0 0"/>)");
  }
}

TEST_SUITE("law") {
  TEST_CASE("rotations read back the same, also where the pitch is near a quarter turn") {
    Rng rng(17);
    for (int i = 0; i < 2000; ++i) {
      const double away = i % 3 == 0 ? 1.0 : i % 3 == 1 ? 1e-8 : 0.0;
      const double pitch = (i % 2 == 0 ? 0.5 : -0.5) * kPi + away * rng.uniform(-1, 1);
      const Vec3 rpy(rng.uniform(-kPi, kPi), pitch, rng.uniform(-kPi, kPi));
      const Transform pose{rotation_from_rpy(rpy), Vec3(rng.uniform(), 0, -rng.uniform())};
      CAPTURE(rpy.transpose());
      CHECK((reread(pose).rotation - pose.rotation).cwiseAbs().maxCoeff() < 1e-15);
      CHECK(reread(pose).translation == pose.translation);
    }
  }
}

}  // namespace mneme
