// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/small_robots.h"
#include "support/support.h"

#include <string>
#include <variant>

namespace mneme {
namespace {

Vec3 random_vector(Rng& rng) {
  return {rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
}

Transform random_pose(Rng& rng) {
  return {rotation_from_rpy(3 * random_vector(rng)), random_vector(rng)};
}

/// A tree with joints of all kinds, some of which follow others.
Robot::Parts random_parts(Rng& rng) {
  Robot::Parts parts = test::make_chain(6);
  parts.joints[3].type = JointType::continuous;
  parts.joints[4].type = JointType::prismatic;
  parts.joints[5].type = JointType::fixed;
  parts.joints[4].parent_link = static_cast<int>(rng.index(5));
  parts.joints[1].mimic = test::follow(4, rng.uniform(-2, 2), rng.uniform());
  for (Joint& joint : parts.joints) {
    joint.origin = random_pose(rng);
    joint.axis = random_vector(rng);
    joint.lower = rng.uniform(-3, 0);
    joint.upper = rng.uniform(0, 3);
  }
  for (Link& link : parts.links) {
    link.spheres.push_back({random_vector(rng), rng.uniform()});
    link.capsules.push_back({random_vector(rng), random_vector(rng), rng.uniform()});
  }
  return parts;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("names and the comment are written so that they can be read") {
    Robot::Parts parts = test::make_chain(2);
    parts.name = "a \"b\" & <c>";
    parts.links[1].name = "l&1";
    parts.joints[1].name = "<j>";
    const std::string text = to_urdf(parts, "made by a test");
    CHECK(test::contains(text, "<!-- made by a test -->"));
    const auto read = parse_robot_parts(text, "text");
    REQUIRE_MESSAGE(read.has_value(), (read ? "" : read.error().message));
    CHECK(read->name == parts.name);
    CHECK(read->links[1].name == "l&1");
    CHECK(read->joints[1].name == "<j>");
  }

  TEST_CASE("capsules along or against z, and of no length, keep their ends") {
    Robot::Parts parts = test::make_chain(1);
    for (const double z : {1.0, -1.0, 0.0}) {
      parts.links[0].capsules.push_back({Vec3(1, 2, 0), Vec3(1, 2, z), 0.1});
    }
    const auto read = parse_robot_parts(to_urdf(parts), "text");
    REQUIRE(read.has_value());
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK((read->links[0].capsules[i].a - parts.links[0].capsules[i].a).norm() < 1e-15);
      CHECK((read->links[0].capsules[i].b - parts.links[0].capsules[i].b).norm() < 1e-15);
    }
  }

  TEST_CASE("solids are written too") {
    const test::TemporaryDirectory directory;
    test::write_file(directory / "a&b.stl", "solid");
    Rng rng(3);
    Robot::Parts parts = test::make_chain(1);
    const Transform pose = random_pose(rng);
    parts.links[0].solids = {Box{pose, Vec3(1, 2, 3)}, Cylinder{pose, 0.5, 2},
                             MeshFile{directory / "a&b.stl", Vec3(1, -1, 2), pose}};
    const auto read = parse_robot_parts(to_urdf(parts), "text");
    REQUIRE_MESSAGE(read.has_value(), (read ? "" : read.error().message));
    const std::vector<Solid>& solids = read->links[0].solids;
    REQUIRE(solids.size() == 3);
    CHECK(std::get<Box>(solids[0]).half_extents == Vec3(1, 2, 3));
    CHECK(std::get<Box>(solids[0]).pose.rotation.isApprox(pose.rotation));
    CHECK(std::get<Cylinder>(solids[1]).length == 2);
    CHECK(std::get<MeshFile>(solids[2]).path == directory / "a&b.stl");
    CHECK(std::get<MeshFile>(solids[2]).scale == Vec3(1, -1, 2));
  }
}

TEST_SUITE("law") {
  TEST_CASE("what is written reads back to a robot of the same hash") {
    Rng rng(11);
    for (int i = 0; i < 200; ++i) {
      CAPTURE(i);
      const Robot::Parts parts = random_parts(rng);
      const auto read = parse_robot(to_urdf(parts), "text");
      REQUIRE_MESSAGE(read.has_value(), (read ? "" : read.error().message));
      CHECK(read->hash() == test::require_robot(parts).hash());
    }
    const auto planar = read_robot(test::source_file("robots/planar8.urdf"));
    REQUIRE(planar.has_value());
    CHECK(parse_robot(to_urdf(*planar), "text").value().hash() == test::planar8().hash());
  }
}

}  // namespace mneme
