// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "report/visuals.h"
#include "support/support.h"

#include <string>
#include <variant>

namespace mneme::internal {
namespace {

/// The looks of the links of a URDF, beside which a mesh of one triangle lies.
std::vector<Visual> looks(const std::string& links) {
  const test::TemporaryDirectory directory;
  test::write_file(directory / "arm.urdf", "<robot name=\"arm\">" + links + "</robot>");
  test::write_file(directory / "part.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  return read_visuals(directory / "arm.urdf", {});
}

std::string visual(const std::string& shape, const std::string& more = "") {
  return "<visual>" + more + "<geometry>" + shape + "</geometry></visual>";
}

TEST_SUITE("unit") {
  TEST_CASE("Looks are shapes in the frames of their links, meshes with their scale") {
    const auto found =
        looks("<link name=\"a\">" + visual("<box size=\"1 2 3\"/>", "<origin xyz=\"0 0 1\"/>") +
              visual("<mesh filename=\"part.obj\" scale=\"2 2 2\"/>") + "</link><link name=\"b\">" +
              visual("<sphere radius=\"0.5\"/>") + "</link>");
    REQUIRE(found.size() == 3);
    CHECK(found[0].link == "a");
    CHECK(std::get<Box>(found[0].shape).pose.translation == Vec3(0, 0, 1));
    CHECK(std::get<Box>(found[0].shape).half_extents == Vec3(0.5, 1, 1.5));
    const auto& mesh = std::get<Mesh>(found[1].shape);
    REQUIRE(mesh.parts->list().size() == 1);
    CHECK(mesh.parts->list()[0].b == Vec3(2, 0, 0));
    CHECK(found[2].link == "b");
    CHECK(std::get<Sphere>(found[2].shape).radius == 0.5);
  }

  TEST_CASE("Colours are those of the material, or of the robot's material of its name") {
    const auto found = looks(
        "<material name=\"red\"><color rgba=\"1 0 0.2 1\"/></material><link name=\"a\">" +
        visual("<sphere radius=\"1\"/>", "<material name=\"red\"/>") +
        visual("<sphere radius=\"1\"/>",
               "<material name=\"x\"><color rgba=\"0 0.5 1 1\"/></material>") +
        visual("<sphere radius=\"1\"/>", "<material name=\"x\"><color rgba=\"1 ?\"/></material>") +
        visual("<sphere radius=\"1\"/>") + "</link>");
    REQUIRE(found.size() == 4);
    CHECK(found[0].color == "#ff0033");
    CHECK(found[1].color == "#0080ff");
    CHECK(found[2].color == "");
    CHECK(found[3].color == "");
  }

  TEST_CASE("What cannot be read is left out; a link without any looks like what is checked") {
    const std::string checked =
        "<collision><geometry><cylinder radius=\"1\" length=\"2\"/></geometry></collision>";
    const auto found =
        looks("<link name=\"a\">" + visual("<mesh filename=\"missing.dae\"/>") +
              visual("<sphere radius=\"1\"/>") + checked + "</link><link name=\"b\">" +
              visual("<mesh filename=\"missing.dae\"/>") + checked +
              "</link><link name=\"c\"><collision><geometry><sphere radius=\"1\"/></geometry>"
              "</collision></link>");
    REQUIRE(found.size() == 2);
    CHECK(std::holds_alternative<Sphere>(found[0].shape));
    CHECK(found[1].link == "b");
    CHECK(std::holds_alternative<Cylinder>(found[1].shape));
  }

  TEST_CASE("A file that is no URDF has no looks") {
    CHECK(read_visuals("/no/such/file.urdf", {}).empty());
    CHECK(looks("<link").empty());
  }
}

}  // namespace
}  // namespace mneme::internal
