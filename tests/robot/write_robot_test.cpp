// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/small_robots.h"
#include "robot/srdf.h"
#include "input/xml_reader.h"
#include "base/text.h"
#include "support/support.h"

#include <string>
#include <variant>
#include <vector>

namespace mneme {
namespace {

using internal::xml_escaped;
using internal::xml_origin;
using internal::xml_vector;
using test::kPi;
using test::require;
using test::require_error;

/// The pose that an origin reads back to.
Transform reread(const Transform& pose) {
  const auto parts = require(parse_robot_parts(
      R"(<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="fixed">)"
      R"(<parent link="a"/><child link="b"/>)" +
          xml_origin(pose) + "</joint></robot>",
      "r.urdf"));
  return parts.joints[0].origin;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("characters that XML reserves are escaped") {
    CHECK(xml_escaped("a<b>&\"c'") == "a&lt;b&gt;&amp;&quot;c&#39;");
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
      const Vec3 rpy{rng.uniform(-kPi, kPi), pitch, rng.uniform(-kPi, kPi)};
      const Transform pose{rotation_from_rpy(rpy), Vec3{rng.uniform(), 0, -rng.uniform()}};
      CAPTURE(rpy.transpose());
      CHECK((reread(pose).rotation - pose.rotation).cwiseAbs().maxCoeff() < 1e-15);
      CHECK(reread(pose).translation == pose.translation);
    }
  }
}

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
  const double offset = rng.uniform(), rate = rng.uniform(-2, 2);
  parts.joints[1].mimic = test::follow(4, rate, offset);
  for (Joint& joint : parts.joints) {
    joint.origin = random_pose(rng);
    joint.axis = random_vector(rng);
    joint.lower = rng.uniform(-3, 0);
    joint.upper = rng.uniform(0, 3);
    joint.velocity = rng.uniform(0, 5);
    if (rng.index(2) == 0) joint.acceleration = rng.uniform(0, 5);
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
    const auto read = require(parse_robot_parts(text, "text"));
    CHECK(read.name == parts.name);
    CHECK(read.links[1].name == "l&1");
    CHECK(read.joints[1].name == "<j>");
  }

  TEST_CASE("capsules along or against z, and of no length, keep their ends") {
    Robot::Parts parts = test::make_chain(1);
    for (const double z : {1.0, -1.0, 0.0}) {
      parts.links[0].capsules.push_back({Vec3(1, 2, 0), Vec3(1, 2, z), 0.1});
    }
    const auto read = require(parse_robot_parts(to_urdf(parts), "text"));
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK((read.links[0].capsules[i].a - parts.links[0].capsules[i].a).norm() < 1e-15);
      CHECK((read.links[0].capsules[i].b - parts.links[0].capsules[i].b).norm() < 1e-15);
    }
  }

  TEST_CASE("solids are written too") {
    const test::TemporaryDirectory directory;
    test::write_file(directory / "a&b.stl", "a mesh");
    Rng rng(3);
    Robot::Parts parts = test::make_chain(1);
    const Transform pose = random_pose(rng);
    parts.links[0].solids = {Box{pose, Vec3(1, 2, 3)}, Cylinder{pose, 0.5, 2},
                             MeshFile{directory / "a&b.stl", Vec3(1, -1, 2), pose}};
    const auto read = require(parse_robot_parts(to_urdf(parts), "text"));
    const std::vector<Solid>& solids = read.links[0].solids;
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
      const auto read = require(parse_robot(to_urdf(parts), "text"));
      const Robot robot = test::require_robot(parts);
      CHECK(read.hash() == robot.hash());
      for (std::size_t j = 0; j < robot.joints().size(); ++j) {
        if (robot.joints()[j].type == JointType::fixed) continue;
        CHECK(read.joints()[j].velocity == robot.joints()[j].velocity);
        CHECK(read.joints()[j].acceleration == robot.joints()[j].acceleration);
      }
    }
    const auto planar = require(read_robot(test::source_file("robots/planar8.urdf")));
    CHECK(parse_robot(to_urdf(planar), "text").value().hash() == test::planar8().hash());
  }
}

namespace {

using test::contains;

Robot::Parts parts_with_groups() {
  Robot::Parts parts = test::make_chain(3);
  parts.name = "a & b";
  parts.groups = {{"arm", {"j1", "j2"}}, {"hand", {"j3"}, true}, {"tool", {}, true}};
  parts.states = {{"at <home>", "arm", {{"j1", 0.1}, {"j2", -1e-7}}}, {"open", "hand", {}}};
  parts.allowed_pairs.emplace();
  parts.allowed_pairs->emplace_back("l0", "l1");
  parts.allowed_pairs->emplace_back("l1", "l2");
  return parts;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("groups, states, end effectors and allowed pairs read back the same") {
    const Robot::Parts parts = parts_with_groups();
    Robot::Parts read = test::make_chain(3);
    read.name = parts.name;
    require(internal::apply_srdf(to_srdf(parts), "text", read));
    CHECK(read.warnings.empty());
    CHECK(read.allowed_pairs == parts.allowed_pairs);
    CHECK(test::require_robot(read).hash() == test::require_robot(parts).hash());
    REQUIRE(read.states.size() == 2);
    for (std::size_t i = 0; i < 2; ++i) {
      CHECK(read.states[i].name == parts.states[i].name);
      CHECK(read.states[i].group == parts.states[i].group);
      CHECK(read.states[i].values == parts.states[i].values);
    }
    REQUIRE(read.groups.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(read.groups[i].name == parts.groups[i].name);
      CHECK(read.groups[i].joints == parts.groups[i].joints);
      CHECK(read.groups[i].is_end_effector == parts.groups[i].is_end_effector);
    }
  }

  TEST_CASE("chains, end effectors, virtual and passive joints read back the same") {
    const std::string text = R"(<robot name="chain">
  <virtual_joint name="v" type="fixed" parent_frame="map" child_link="l0"/>
  <virtual_joint name="p" type="planar" parent_frame="odom" child_link="l0"/>
  <group name="arm">
    <chain base_link="l0" tip_link="l2"/>
  </group>
  <group name="base">
    <joint name="p"/>
  </group>
  <group name="hand">
    <joint name="j3"/>
  </group>
  <end_effector name="tool" parent_link="l2" group="hand" parent_group="arm"/>
  <passive_joint name="j1"/>
</robot>
)";
    Robot::Parts parts = test::make_chain(3);
    require(internal::apply_srdf(text, "text", parts));
    const std::string written = to_srdf(parts);
    CHECK(written.substr(written.find("  <")) == text.substr(text.find("  <")));
    Robot::Parts read = test::make_chain(3);
    require(internal::apply_srdf(written, "text", read));
    CHECK(read.root_frame == "map");
    CHECK(read.groups.at(0).tip == "l2");
    CHECK(read.groups.at(0).joints == std::vector<std::string>{"j2"});
    CHECK(read.groups.at(1).virtual_joint == "p");
    CHECK(read.groups.at(2).is_end_effector);
  }

  TEST_CASE("the reason of each pair, the comment and the parents of end effectors are written") {
    const std::vector<std::string> reasons{"Adjacent"};
    const std::string text = to_srdf(parts_with_groups(), reasons, "made by a test");
    CHECK(contains(text, R"(link1="l0" link2="l1" reason="Adjacent"/>)"));
    CHECK(contains(text, R"(link1="l1" link2="l2" reason="User"/>)"));
    CHECK(contains(text, "<!-- made by a test -->"));
    CHECK(contains(text, R"(<end_effector name="hand" parent_link="l2" group="hand"/>)"));
    CHECK(contains(text, R"(<end_effector name="tool" parent_link="l0" group="tool"/>)"));
  }

  TEST_CASE("parts without groups and pairs give an SRDF that allows nothing") {
    Robot::Parts read = test::make_chain(2);
    CHECK(internal::apply_srdf(to_srdf(test::make_chain(2)), "text", read).has_value());
    CHECK(read.groups.empty());
    CHECK(read.allowed_pairs.value().empty());
  }
}

namespace {

const std::vector<double> kPlanar8{1.6, 1.4, 1.8, 1.2, 1.5, 1.3, 1.1, 1.7};

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("planar8.urdf is what the generator writes") {
    const auto urdf = require(planar_arm_urdf("planar8", kPlanar8));
    CHECK(urdf == test::read_file(test::source_file("robots/planar8.urdf")));
  }

  TEST_CASE("the arm has the stated links, joints and limits") {
    const Robot arm = test::planar8();
    CHECK(arm.name() == "planar8");
    CHECK(arm.is_planar());
    CHECK(arm.links()[0].name == "base");
    CHECK(arm.links()[0].capsules.empty());
    REQUIRE(arm.joint_count() == 8);
    for (int i = 0; i < 8; ++i) {
      const Joint& joint = arm.group_joint(i);
      CHECK(joint.name == "joint_" + std::to_string(i + 1));
      CHECK(joint.type == (i == 0 ? JointType::continuous : JointType::revolute));
      CHECK(joint.lower == -test::kPi);
      CHECK(joint.upper == test::kPi);
      const Link& link = arm.links()[static_cast<std::size_t>(joint.child_link)];
      CHECK(link.name == "link_" + std::to_string(i + 1));
      REQUIRE(link.capsules.size() == 1);
      CHECK(link.capsules[0].radius == 0.0005);
      CHECK(link.capsules[0].a.norm() < 1e-15);
      const Vec3 tip(kPlanar8[static_cast<std::size_t>(i)], 0, 0);
      CHECK((link.capsules[0].b - tip).norm() < 1e-15);
    }
    CHECK(arm.self_pairs().size() == 21);
  }

  TEST_CASE("an arm of any number of links and any name can be read back") {
    for (const std::size_t count : {std::size_t{1}, std::size_t{2}, std::size_t{50}}) {
      const auto urdf =
          require(planar_arm_urdf("<\"a&b'>", std::vector<double>(count, 1.0 / 3), 0.2));
      const auto robot = require(parse_robot(urdf, "arm.urdf"));
      CHECK(robot.name() == "<\"a&b'>");
      CHECK(robot.joint_count() == static_cast<int>(count));
      CHECK(robot.links().back().capsules[0].radius == 0.1);
      const auto poses = robot.link_poses(Configuration(count, 0.0));
      CHECK(poses.back().translation.x() == doctest::Approx(static_cast<double>(count - 1) / 3));
    }
  }

  TEST_CASE("lengths and thickness that are not positive are refused") {
    CHECK_FALSE(planar_arm_urdf("arm", {}).has_value());
    CHECK_FALSE(planar_arm_urdf("", kPlanar8).has_value());
    CHECK_FALSE(planar_arm_urdf("arm", kPlanar8, 0).has_value());
    for (const double bad : std::vector<double>{0, -1, NAN, INFINITY}) {
      const Error error = require_error(planar_arm_urdf("arm", std::vector{1.0, bad}));
      CHECK(error.code == ErrorCode::invalid);
      CHECK(test::contains(error.message, "length of link 2"));
    }
  }
}

}  // namespace mneme
