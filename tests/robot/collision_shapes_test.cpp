// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Shapes of <collision> elements.
#include "mneme/robot.h"

#include "support/support.h"

#include <string>
#include <variant>
#include <vector>

namespace mneme {
namespace {

/// A robot of one link with this geometry, in a frame that is turned about x and shifted.
std::string with_geometry(const std::string& geometry) {
  return R"(<robot name="r"><link name="arm"><collision>
<origin xyz="1 2 3" rpy="1.5707963267948966 0 0"/><geometry>
)" + geometry +
         R"(
</geometry></collision></link></robot>)";
}

Link read_link(const std::string& geometry, const std::string& source = "r.urdf") {
  const auto parts = parse_robot_parts(with_geometry(geometry), source);
  REQUIRE_MESSAGE(parts.has_value(), (parts ? "" : parts.error().message));
  return parts->links.at(0);
}

void check_pose(const Transform& pose) {
  CHECK(pose.translation == Vec3(1, 2, 3));
  CHECK(pose.rotation.isApprox(rotation_about(Vec3::UnitX(), test::kPi / 2)));
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("flat shapes get a thickness of 0.1 mm, and one scale counts for all axes") {
    const Link plate = read_link(R"(<box size="1 2 0"/>)");
    CHECK(std::get<Box>(plate.solids.at(0)).half_extents.isApprox(Vec3(0.5, 1, 5e-5)));
    const Link disc = read_link(R"(<cylinder radius="1" length="0"/>)");
    CHECK(std::get<Cylinder>(disc.solids.at(0)).length == 1e-4);
    CHECK(read_link(R"(<cylinder radius="0" length="0"/>)").solids.empty());
    CHECK(read_link(R"(<drake:capsule radius="1" length="2"/>)").capsules.size() == 1);
    const test::TemporaryDirectory directory;
    test::write_file(directory / "a.stl", "a mesh");
    const Link scaled = read_link(R"(<mesh filename="a.stl" scale="0.5"/>)", directory / "r.urdf");
    CHECK(std::get<MeshFile>(scaled.solids.at(0)).scale == Vec3::Constant(0.5));
  }

  TEST_CASE("spheres and capsules become shapes, the rest solids, all at their poses") {
    const Sphere sphere = read_link(R"(<sphere radius="0.1"/>)").spheres.at(0);
    CHECK(sphere.center == Vec3(1, 2, 3));
    const Capsule capsule = read_link(R"(<capsule radius="0.1" length="2"/>)").capsules.at(0);
    CHECK((capsule.b - Vec3(1, 1, 3)).norm() < 1e-15);
    const Link box = read_link(R"(<box size="0.2 0.4 0.6"/>)");
    CHECK(box.spheres.empty());
    check_pose(std::get<Box>(box.solids.at(0)).pose);
    CHECK(std::get<Box>(box.solids.at(0)).half_extents.isApprox(Vec3(0.1, 0.2, 0.3)));
    const Link cylinder = read_link(R"(<cylinder radius="0.1" length="2"/>)");
    check_pose(std::get<Cylinder>(cylinder.solids.at(0)).pose);
    CHECK(std::get<Cylinder>(cylinder.solids.at(0)).radius == 0.1);
    CHECK(std::get<Cylinder>(cylinder.solids.at(0)).length == 2);
  }

  TEST_CASE("meshes are found and keep their scale") {
    const test::TemporaryDirectory directory;
    test::write_file(directory / "a.stl", "a mesh");
    const std::string urdf = directory / "r.urdf";
    const Link plain = read_link(R"(<mesh filename="a.stl"/>)", urdf);
    check_pose(std::get<MeshFile>(plain.solids.at(0)).pose);
    CHECK(std::get<MeshFile>(plain.solids.at(0)).path == directory / "a.stl");
    CHECK(std::get<MeshFile>(plain.solids.at(0)).scale == Vec3::Ones());
    const Link mirrored = read_link(R"(<mesh filename="a.stl" scale="0.1 -1 2"/>)", urdf);
    CHECK(std::get<MeshFile>(mirrored.solids.at(0)).scale == Vec3(0.1, -1, 2));
  }

  TEST_CASE("binary STL files without triangles are left aside, cut ones are not") {
    const test::TemporaryDirectory directory;
    const auto solids = [&](const std::string& bytes) {
      test::write_file(directory / "a.stl", bytes);
      return read_link(R"(<mesh filename="a.stl"/>)", directory / "r.urdf").solids.size();
    };
    const std::string zeros(80, '\0');
    CHECK(solids(zeros) == 0);
    CHECK(solids(std::string(80, 'x') + std::string(4, '\0')) == 0);
    CHECK(solids(std::string(80, 'x')) == 1);
    CHECK(solids(zeros + std::string("\1\0\0\0", 4)) == 1);
    CHECK(solids(zeros.substr(1)) == 1);
  }

  TEST_CASE("a link may have several collisions of different kinds") {
    std::string text = with_geometry(R"(<box size="1 1 1"/>)");
    const std::string more = R"(<collision><geometry><cylinder radius="1" length="1"/></geometry>
      </collision><collision><geometry><sphere radius="1"/></geometry></collision>)";
    const auto parts = parse_robot_parts(text.replace(text.find("</link>"), 0, more), "r.urdf");
    REQUIRE(parts.has_value());
    CHECK(parts->links[0].solids.size() == 2);
    CHECK(parts->links[0].spheres.size() == 1);
  }

  TEST_CASE("geometry that is malformed is refused with file, line, link and element") {
    struct Case {
      std::string geometry, part;
      ErrorCode code = ErrorCode::parse;
    };
    const std::vector<Case> cases{
        {"<box/>", "<box>: attribute 'size' is missing"},
        {"<box size=\"1 1\"/>", "<box>: size is '1 1', expected three"},
        {"<box size=\"1 0 1\"/>", "<box>: size is 1 0 1, expected three numbers above 0"},
        {"<box size=\"1 1 1\" radius=\"1\"/>", "<box>: unknown attribute 'radius'"},
        {"<cylinder radius=\"1\"/>", "<cylinder>: attribute 'length' is missing"},
        {"<cylinder radius=\"0\" length=\"1\"/>", "<cylinder>: radius is 0, expected more than 0"},
        {"<cylinder radius=\"1\" length=\"-1\"/>", "<cylinder>: length is -1"},
        {"<mesh/>", "<mesh>: attribute 'filename' is missing"},
        {"<mesh filename=\"\"/>", "<mesh>: 'filename' is empty"},
        {"<mesh filename=\"a.stl\" scale=\"2\"/>", "<mesh>: scale is '2', expected three"},
        {"<mesh filename=\"a.stl\" scale=\"1 1 0\"/>", "<mesh>: a scale is 0"},
        {"<mesh filename=\"..\"/>", "<mesh>: '..': expected a file; ", ErrorCode::io},
        {"<mesh filename=\"absent.stl\"/>", "<mesh>: 'absent.stl': there is no such file; searched",
         ErrorCode::io},
        {"<mesh filename=\"http://a/b.stl\"/>", "<mesh>: 'http://a/b.stl': expected package://",
         ErrorCode::unsupported},
        {"<mesh filename=\"package://p/../b.stl\"/>", "the path leaves the package 'p'"},
        {"<cone radius=\"1\"/>", "unknown element <cone> in <geometry>"},
    };
    RobotOptions strict;
    strict.strict = true;
    for (const Case& c : cases) {
      CAPTURE(c.geometry);
      const auto parts = parse_robot_parts(with_geometry(c.geometry), "r.urdf", strict);
      REQUIRE_FALSE(parts.has_value());
      const std::string& message = parts.error().message;
      CHECK_MESSAGE(message.starts_with("r.urdf:3: link 'arm': "), message);
      CHECK_MESSAGE(test::contains(message, c.part), message);
      CHECK(parts.error().code == c.code);
    }
  }
}

}  // namespace mneme
