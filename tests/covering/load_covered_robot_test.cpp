// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/covering.h"

#include "covering/solids.h"
#include "support/environment.h"

#include <filesystem>

namespace mneme::test {
namespace {

std::string link_of(const std::string& name, const std::string& geometry) {
  return "<link name=\"" + name + "\"><collision><geometry>" + geometry +
         "</geometry></collision></link>";
}

/// Three links in a row along x; the second is a mesh file, "part.stl".
std::string make_urdf() {
  const std::string joint =
      "<parent link=\"{}\"/><child link=\"{}\"/><axis xyz=\"0 0 1\"/>"
      "<origin xyz=\"0.4 0 0\"/>"
      "<limit lower=\"-2\" upper=\"2\" effort=\"1\" velocity=\"1\"/></joint>";
  return "<robot name=\"r\">" + link_of("a", "<box size=\"0.3 0.08 0.08\"/>") +
         link_of("b", "<mesh filename=\"part.stl\"/>") +
         link_of("c", "<cylinder radius=\"0.05\" length=\"0.2\"/>") +
         "<joint name=\"j\" type=\"revolute\">" + fmt::format(fmt::runtime(joint), "a", "b") +
         "<joint name=\"k\" type=\"revolute\">" + fmt::format(fmt::runtime(joint), "b", "c") +
         "</robot>";
}

struct RobotFiles {
  RobotFiles() {
    write_file(files / "r.urdf", make_urdf());
    write_file(files / "part.stl",
               to_binary_stl(internal::triangulate(make_box({0.3, 0.08, 0.08}))));
  }
  [[nodiscard]] CoveredRobot load(const RobotOptions& options = {}) const {
    auto robot = load_covered_robot(files / "r.urdf", options);
    REQUIRE_MESSAGE(robot.has_value(), (robot ? "" : robot.error().message));
    return *robot;
  }
  TemporaryDirectory files;
  EnvironmentVariable home{"XDG_CACHE_HOME", files / "cache"};
};

TEST_SUITE("unit") {
  TEST_CASE(
      "a robot of boxes, cylinders and meshes is covered, and the cache makes no difference") {
    const RobotFiles files;
    const CoveredRobot first = files.load();
    REQUIRE(first.notes.size() == 1);
    CHECK(contains(first.notes[0], "covered the geometry of 3 links with"));
    CHECK_FALSE(contains(first.notes[0], "cache"));
    for (const Link& link : first.robot.links()) CHECK_FALSE(link.spheres.empty());
    const CoveredRobot second = files.load();
    REQUIRE(second.notes.size() == 1);
    CHECK(contains(second.notes[0], "; 3 from the cache " + files.files / "cache/mneme"));
    CHECK(second.robot.hash() == first.robot.hash());
  }

  TEST_CASE("a cache that cannot be written is said, and loses nothing else") {
    const RobotFiles files;
    const std::string hash = files.load().robot.hash();
    std::filesystem::remove_all(files.files / "cache");
    write_file(files.files / "cache", "in the way");
    const CoveredRobot robot = files.load();
    REQUIRE(robot.notes.size() == 1);
    CHECK(contains(robot.notes[0], "cannot be written"));
    CHECK(robot.robot.hash() == hash);
  }

  TEST_CASE("without an SRDF neighbours may touch; with one only what it allows") {
    const RobotFiles files;
    const Robot alone = files.load().robot;
    REQUIRE(alone.self_pairs().size() == 1);
    CHECK(alone.self_pairs()[0] == std::pair(0, 2));
    write_file(files.files / "r.srdf",
               "<robot name=\"r\"><disable_collisions link1=\"a\" link2=\"c\" reason=\"Never\"/>"
               "</robot>");
    const Robot with_srdf = files.load().robot;
    REQUIRE(with_srdf.self_pairs().size() == 2);
    CHECK(with_srdf.self_pairs()[0] == std::pair(0, 1));
    CHECK(with_srdf.self_pairs()[1] == std::pair(1, 2));
  }

  TEST_CASE("a robot without solids is loaded as ever") {
    const auto robot = load_covered_robot(source_file("robots/planar8.urdf"));
    REQUIRE(robot.has_value());
    CHECK(robot->notes.empty());
    CHECK(robot->robot.hash() == planar8().hash());
  }

  TEST_CASE("errors name the robot's file") {
    const RobotFiles files;
    write_file(files.files / "part.stl", "rubbish");
    const auto robot = load_covered_robot(files.files / "r.urdf");
    REQUIRE_FALSE(robot.has_value());
    CHECK(contains(robot.error().message, files.files / "r.urdf"));
    CHECK(contains(robot.error().message, "link 'b'"));
    CHECK(contains(robot.error().message, files.files / "part.stl"));
    RobotOptions options;
    options.joints = {"nobody"};
    write_file(files.files / "part.stl",
               to_binary_stl(internal::triangulate(make_box({0.3, 0.08, 0.08}))));
    const auto wrong = load_covered_robot(files.files / "r.urdf", options);
    REQUIRE_FALSE(wrong.has_value());
    CHECK(contains(wrong.error().message, "nobody"));
    CHECK_FALSE(load_covered_robot(files.files / "missing.urdf").has_value());
  }
}

}  // namespace
}  // namespace mneme::test
