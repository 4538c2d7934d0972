// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/held_joints.h"
#include "robot/small_robots.h"

#include <doctest/doctest.h>

#include <numbers>
#include <string>

namespace mneme::test {
namespace {

constexpr double kQuarter = std::numbers::pi / 2;

/// A cart on a plane, or in the air, 1 m above the ground, with an arm that turns.
std::string cart(const std::string& type, const std::string& axis = "") {
  return R"(<robot name="cart"><link name="ground"/>
    <link name="cart"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
    <link name="arm"/>
    <joint name="base" type=")" +
         type + R"("><parent link="ground"/><child link="cart"/><origin xyz="0 0 1"/>)" + axis +
         R"(</joint>
    <joint name="turn" type="revolute"><parent link="cart"/><child link="arm"/>
      <origin xyz="0.5 0 0"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1"/></joint>
    </robot>)";
}

Result<Robot> held(const std::string& urdf, const std::map<std::string, double>& values) {
  return parse_robot(urdf, "cart.urdf", {.fixed_values = values});
}

Transform pose_of(const Robot& robot, const std::string& link) {
  return robot.link_poses(Configuration{0.0})[static_cast<std::size_t>(*robot.find_link(link))];
}

void check_near(const Vec3& found, const Vec3& expected) {
  CHECK_MESSAGE((found - expected).norm() < 1e-12, found.transpose());
}

TEST_SUITE("unit") {
  TEST_CASE("a planar joint stands where its fixed values say") {
    const Robot robot =
        held(cart("planar"), {{"base/x", 2}, {"base/y", 3}, {"base/theta", kQuarter}}).value();
    CHECK(robot.joint_count() == 1);
    check_near(pose_of(robot, "cart").translation, {2, 3, 1});
    check_near(pose_of(robot, "arm").translation, {2, 3.5, 1});
  }

  TEST_CASE("a planar joint moves across its axis and turns about it") {
    const Robot robot =
        held(cart("planar", "<axis xyz=\"0 1 0\"/>"), {{"base/theta", kQuarter}, {"base/y", 2}})
            .value();
    // FromTwoVectors turns z to y about -x, and so y to -z.
    check_near(pose_of(robot, "cart").translation, {0, 0, -1});
    check_near(pose_of(robot, "arm").translation, {0, 0, -1.5});
  }

  TEST_CASE("a floating joint stands where its fixed values say") {
    const double half = std::sqrt(0.5);
    const Robot robot = held(cart("floating"), {{"base/trans_x", 1},
                                                {"base/trans_y", 2},
                                                {"base/trans_z", 3},
                                                {"base/rot_y", half},
                                                {"base/rot_w", half}})
                            .value();
    check_near(pose_of(robot, "cart").translation, {1, 2, 4});
    check_near(pose_of(robot, "arm").translation, {1, 2, 3.5});
  }

  TEST_CASE("a planar joint's axis is a direction of any length, but not zero") {
    const std::map<std::string, double> values{{"base/x", 1}, {"base/theta", 0.5}};
    const Transform pose = pose_of(held(cart("planar"), values).value(), "arm");
    const Robot longer = held(cart("planar", "<axis xyz=\"0 0 5\"/>"), values).value();
    check_near(pose_of(longer, "arm").translation, pose.translation);
    CHECK(pose_of(longer, "arm").rotation.isApprox(pose.rotation));
    const Error error = require_error(held(cart("planar", "<axis xyz=\"0 0 0\"/>"), values));
    CHECK(contains(error.message, "joint 'base': its axis (0, 0, 0) is no direction"));
  }

  TEST_CASE("without values planar and floating joints stay at their origin, and robots differ") {
    const Robot still = held(cart("planar"), {}).value();
    CHECK(pose_of(still, "cart").translation == Vec3(0, 0, 1));
    CHECK(still.hash() != held(cart("planar"), {{"base/x", 2}})->hash());
  }

  TEST_CASE("values that are no pose are refused by name") {
    const auto refusal = [](const std::string& type, const std::map<std::string, double>& values) {
      return require_error(held(cart(type), values)).message;
    };
    CHECK(contains(refusal("planar", {{"base/x", std::nan("")}}), "'base/x' is nan"));
    CHECK(contains(refusal("planar", {{"base", 1}}),
                   "joint 'base' is planar: its fixed values are base/theta, base/x, base/y"));
    CHECK(contains(refusal("planar", {{"base/trans_x", 1}}), "'base/trans_x'"));
    CHECK(contains(refusal("floating", {{"base/rot_w", 0.5}}), "has the length 0.5, expected 1"));
  }
}

TEST_SUITE("law") {
  TEST_CASE("the values of a pose describe that pose") {
    for (const char* axis : {"", "<axis xyz=\"0.6 0 0.8\"/>"}) {
      for (const auto& [type, values] : std::map<std::string, std::map<std::string, double>>{
               {"planar", {{"base/x", 0.3}, {"base/y", -2}, {"base/theta", 2.5}}},
               {"floating", {{"base/trans_z", -2}, {"base/rot_x", 0.6}, {"base/rot_w", 0.8}}}}) {
        const Robot robot = held(cart(type, axis), values).value();
        const Joint& joint = robot.joints()[0];
        REQUIRE(joint.held);
        for (const auto& [key, value] : internal::held_values(joint, joint.held->pose)) {
          const std::string& name = key;
          CAPTURE(name);
          CHECK(value == doctest::Approx(values.contains(name) ? values.at(name) : 0));
        }
      }
    }
  }
}

}  // namespace
}  // namespace mneme::test
