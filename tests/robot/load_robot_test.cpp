// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/small_robots.h"
#include "support/support.h"

#include <filesystem>
#include <string>

namespace mneme {
namespace {

using test::contains;

const std::string kUrdf = R"(<robot name="arm">
  <link name="base"/><link name="upper"/><link name="tool"/>
  <joint name="lift" type="prismatic"><parent link="base"/><child link="upper"/>
    <limit lower="0" upper="1"/></joint>
  <joint name="turn" type="continuous"><parent link="upper"/><child link="tool"/></joint>
</robot>
)";

std::string srdf_for(const std::string& joint) {
  return "<robot name=\"arm\"><group name=\"g\"><joint name=\"" + joint + "\"/></group></robot>";
}

RobotOptions with_srdf(const std::string& path) {
  RobotOptions options;
  options.srdf_path = path;
  return options;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a file and its text give the same robot") {
    const test::TemporaryDirectory directory;
    test::write_file(directory / "arm.urdf", kUrdf);
    CHECK(load_robot(directory / "arm.urdf").value().hash() ==
          parse_robot(kUrdf, "text").value().hash());
  }

  TEST_CASE("the SRDF beside a URDF counts, unless the options name another") {
    const test::TemporaryDirectory directory;
    test::write_file(directory / "arm.urdf", kUrdf);
    test::write_file(directory / "arm.srdf", srdf_for("turn"));
    test::write_file(directory / "other.srdf", srdf_for("lift"));
    CHECK(load_robot(directory / "arm.urdf").value().group_joint(0).name == "turn");
    CHECK(load_robot(directory / "arm.urdf", with_srdf(directory / "other.srdf"))
              .value()
              .group_joint(0)
              .name == "lift");
    CHECK(parse_robot(kUrdf, directory / "arm.urdf").value().joint_count() == 2);
  }

  TEST_CASE("a robot's parts can be made into the robot that is loaded") {
    const test::TemporaryDirectory directory;
    test::write_file(directory / "arm.urdf", kUrdf);
    test::write_file(directory / "arm.srdf", srdf_for("turn"));
    const auto parts = read_robot(directory / "arm.urdf");
    REQUIRE(parts.has_value());
    CHECK(parts->groups.size() == 1);
    CHECK(make_robot(*parts).value().hash() == load_robot(directory / "arm.urdf").value().hash());
  }

  TEST_CASE("files that cannot be read or are too long are errors that name the file") {
    const test::TemporaryDirectory directory;
    const std::string absent = directory / "absent.urdf";
    CHECK(load_robot(absent).error().code == ErrorCode::io);
    CHECK(contains(load_robot(absent).error().message, absent + ": cannot be read: No such file"));
    const std::string large = directory / "large.urdf";
    test::write_file(large, kUrdf);
    std::filesystem::resize_file(large, (std::uintmax_t{64} << 20) + 1);
    CHECK(contains(load_robot(large).error().message,
                   large + ": expected a file of at most 67108864 bytes"));
    const auto no_srdf = parse_robot(kUrdf, "arm.urdf", with_srdf(directory / "no.srdf"));
    CHECK(no_srdf.error().code == ErrorCode::io);
    CHECK(contains(no_srdf.error().message, "no.srdf: cannot be read"));
  }

  TEST_CASE("options that do not fit the robot are errors that name the file") {
    const auto robot = parse_robot(kUrdf, "arm.urdf", test::plan_for({"elbow"}));
    REQUIRE_FALSE(robot.has_value());
    CHECK(robot.error().code == ErrorCode::invalid);
    CHECK(robot.error().message.starts_with("arm.urdf: robot 'arm': there is no joint 'elbow'"));
  }
}

}  // namespace mneme
