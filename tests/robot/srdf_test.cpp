// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/robot_tree.h"
#include "robot/small_robots.h"
#include "robot/srdf.h"
#include "support/support.h"

#include <string>
#include <utility>
#include <vector>

namespace mneme {
namespace {

using internal::read_srdf;
using internal::Srdf;
using test::contains;
using test::require;
using test::require_error;

const std::string kSrdf = R"(<?xml version="1.0"?>
<robot name="arm">
  <!-- a comment -->
  <group name="all">
    <joint name="j1"/>
    <link name="l2"/>
    <chain base_link="l0" tip_link="l3"/>
    <group name="hand"/>
    <passive_joint name="j9"/>
  </group>
  <group name="hand"/>
  <group_state name="home" group="all"><joint name="j1" value="0"/></group_state>
  <end_effector name="tool" parent_link="l2" group="hand"/>
  <virtual_joint name="world" type="fixed" parent_frame="map" child_link="l0"/>
  <passive_joint name="wheel"/>
  <disable_collisions link1="l0" link2="l1" reason="Adjacent"/>
  <disable_default_collisions link="l2"/>
  <enable_collisions link1="l2" link2="l0"/>
</robot>
)";

struct Malformed {
  std::string from, to;
  int line;
  std::string part;
};

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("every element that matters is read with its line") {
    const auto srdf = require(read_srdf(kSrdf, "arm.srdf"));
    CHECK(srdf.robot.name == "arm");
    REQUIRE(srdf.groups.size() == 2);
    const internal::SrdfGroup& all = srdf.groups[0];
    CHECK(all.name.name == "all");
    CHECK(all.joints.at(0).name == "j1");
    CHECK(all.joints.at(0).line == 5);
    CHECK(all.links.at(0).name == "l2");
    CHECK(all.chains.at(0).first.name == "l0");
    CHECK(all.chains.at(0).second.name == "l3");
    CHECK(all.subgroups.at(0).name == "hand");
    CHECK(srdf.end_effectors.at(0).group.name == "hand");
    CHECK(srdf.end_effectors.at(0).name == "tool");
    CHECK(srdf.virtual_joints.at(0).name.name == "world");
    CHECK(srdf.passive_joints.at(0).name == "wheel");
    CHECK(srdf.disabled.at(0).second.name == "l1");
    CHECK(srdf.disabled.at(0).second.line == 16);
    CHECK(srdf.disabled_links.at(0).name == "l2");
    CHECK(srdf.enabled.at(0).first.name == "l2");
  }

  TEST_CASE("what is malformed is refused with file, line and element") {
    const std::vector<Malformed> cases{
        {"</robot>", "", 2, "malformed XML"},
        {"<robot name=\"arm\">", "<robot>", 2, "<robot>: attribute 'name' is missing"},
        {"<group name=\"hand\"/>\n  <group_state", "<group/>\n  <group_state", 11,
         "<group>: attribute 'name' is missing"},
        {"<group name=\"hand\"/>\n  <group_state", "<group name=\"all\"/>\n  <group_state", 11,
         "group 'all': it is defined twice"},
        {"<joint name=\"j1\"/>", "<joint nam=\"j1\"/>", 5,
         "group 'all': <joint>: unknown attribute 'nam'"},
        {"<joint name=\"j1\"/>", "<joint name=\"\"/>", 5, "group 'all': <joint>: 'name' is empty"},
        {"<joint name=\"j1\"/>", "<joints name=\"j1\"/>", 5, "unknown element <joints> in <group>"},
        {" tip_link=\"l3\"", "", 7, "group 'all': <chain>: attribute 'tip_link' is missing"},
        {" link2=\"l1\"", "", 16, "<disable_collisions>: attribute 'link2' is missing"},
        {"<disable_collisions", "<disable_collision", 16, "unknown element <disable_collision>"},
        {" group=\"hand\"", "", 13, "<end_effector>: attribute 'group' is missing"},
        {"<passive_joint name=\"wheel\"/>", "<passive_joint/>", 15, "<passive_joint>: attribute"},
        {"<disable_default_collisions link=\"l2\"/>", "<disable_default_collisions/>", 17,
         "<disable_default_collisions>: attribute 'link' is missing"},
    };
    for (const Malformed& c : cases) {
      CAPTURE(c.to);
      std::string text = kSrdf;
      const std::size_t at = text.find(c.from);
      REQUIRE_MESSAGE(at != std::string::npos, c.from);
      const Error error =
          require_error(read_srdf(text.replace(at, c.from.size(), c.to), "arm.srdf", true));
      const std::string& message = error.message;
      CHECK_MESSAGE(message.starts_with("arm.srdf:" + std::to_string(c.line) + ": "), message);
      CHECK_MESSAGE(contains(message, c.part), message);
      CHECK(error.code == ErrorCode::parse);
    }
  }

  TEST_CASE("text, unknown elements and a state without a group are one warning") {
    std::string text = kSrdf;
    constexpr std::string_view kState = " group=\"all\"><joint";
    text.replace(text.find(kState), kState.size(), "><claw/><joint");
    constexpr std::string_view kComment = "<!-- a comment -->";
    text.replace(text.find(kComment), kComment.size(), "\\");
    constexpr std::string_view kJoint = "<joint name=\"j1\"/>";
    text.insert(text.find(kJoint), "stray");
    const auto srdf = require(read_srdf(text, "arm.srdf"));
    REQUIRE(srdf.warnings.size() == 1);
    CHECK(srdf.warnings[0] ==
          "arm.srdf: tolerated 4 faults (an error if strict): text '\\' in <robot> (line 3); text "
          "'stray' in <group> (line 5); <group_state>: no group (line 12); unknown element <claw> "
          "in <group_state> (line 12)");
    CHECK(srdf.states.at(0).joints.size() == 1);
    CHECK_FALSE(read_srdf(text, "arm.srdf", true).has_value());
    CHECK(srdf.disabled.size() == read_srdf(kSrdf, "arm.srdf")->disabled.size());
  }

  TEST_CASE("a document that is no SRDF is refused") {
    CHECK(contains(read_srdf("", "a").error().message, "a:1: "));
    CHECK(contains(read_srdf("<urdf/>", "a").error().message, "no <robot> element"));
    CHECK(contains(read_srdf(std::string((std::size_t{64} << 20) + 1, ' '), "a").error().message,
                   "longer than 64 MB"));
  }
}

TEST_SUITE("law") {
  TEST_CASE("no single damaged byte brings the reader down") {
    Rng rng(43);
    for (int repetition = 0; repetition < 3000; ++repetition) {
      std::string text = kSrdf;
      text[rng.index(static_cast<std::uint32_t>(text.size()))] = static_cast<char>(rng.index(256));
      const auto srdf = read_srdf(text, "arm.srdf");
      if (!srdf) CHECK(srdf.error().message.starts_with("arm.srdf:"));
    }
  }
}

namespace {

using internal::apply_srdf;
using Names = std::vector<std::string>;
using LinkPairs = std::vector<std::pair<std::string, std::string>>;

/// A chain of five joints to which an SRDF with these elements is applied.
Robot::Parts applied(const std::string& elements, Robot::Parts parts = test::make_chain(5)) {
  auto sorted = require(internal::sort_tree(std::move(parts)));
  const auto fault =
      apply_srdf("<robot name=\"chain\">\n" + elements + "</robot>", "a.srdf", sorted);
  REQUIRE_MESSAGE(fault.has_value(), (fault ? "" : fault.error().message));
  return sorted;
}

Names first_group(const std::string& content, Robot::Parts parts = test::make_chain(5)) {
  return applied("<group name=\"g\">" + content + "</group>", std::move(parts)).groups.at(0).joints;
}

std::vector<std::pair<int, int>> pairs_of(const Robot::Parts& parts) {
  const Robot robot = test::require_robot(parts);
  return {robot.self_pairs().begin(), robot.self_pairs().end()};
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("findings in an SRDF are a warning of the robot") {
    CHECK(
        applied("stray").warnings ==
        Names{"a.srdf: tolerated 1 fault (an error if strict): text 'stray' in <robot> (line 2)"});
  }

  TEST_CASE("a virtual joint of the planned group and its value in a state are warnings") {
    const auto warnings_of = [](const std::string& group) {
      const Robot::Parts parts = applied(
          R"(<virtual_joint name="odom" type="planar" parent_frame="map" child_link="l0"/>
             <group name="arm"><joint name="j1"/></group>
             <group name="all"><group name="arm"/><joint name="odom"/></group>
             <group_state name="far" group="all"><joint name="odom" value="1 0 0"/>
             <joint name="j1" value=" 0.3 "/></group_state>)");
      const Robot robot = test::require_robot(parts, {.group = group});
      CHECK(robot.named_states()[0].values == std::map<std::string, double>{{"j1", 0.3}});
      return Names(robot.warnings().begin(), robot.warnings().end());
    };
    const Names all = warnings_of("all");
    REQUIRE(all.size() == 2);
    CHECK(
        all[0] ==
        "a.srdf: tolerated 1 fault (an error if strict): group_state 'far': <joint>: joint 'odom' "
        "has several values and is ignored (line 5)");
    CHECK(all[1] ==
          "group 'all' has the virtual joint 'odom', which cannot be planned for: the base stays "
          "where it is");
    CHECK(warnings_of("arm").size() == 1);
  }

  TEST_CASE("groups are unions of joints, links' joints, chains and groups, in tree order") {
    CHECK(first_group(R"(<joint name="j4"/><joint name="j1"/>)") == Names{"j1", "j4"});
    CHECK(first_group(R"(<link name="l0"/><link name="l2"/>)") == Names{"j2"});
    CHECK(first_group(R"(<chain base_link="l1" tip_link="l3"/>)") == Names{"j2", "j3"});
    const Robot::Parts parts = applied(R"(<group name="both"><group name="a"/><group name="b"/>
      </group><group name="a"><joint name="j5"/></group>
      <group name="b"><joint name="j2"/><group name="both"/></group>)");
    CHECK(parts.groups.at(0).joints == Names{"j2", "j5"});
    CHECK(parts.groups.at(1).joints == Names{"j5"});
    CHECK(parts.warnings.empty());
  }

  TEST_CASE("fixed, following, passive and virtual joints are in no group") {
    Robot::Parts parts = test::make_chain(5);
    parts.joints[0].type = JointType::fixed;
    parts.joints[1].mimic = test::follow(2);
    const Robot::Parts read = applied(
        R"(<virtual_joint name="world" type="floating" parent_frame="map" child_link="l0"/>
           <passive_joint name="j4"/><group name="g"><joint name="world"/>
           <chain base_link="l0" tip_link="l5"/></group>)",
        parts);
    CHECK(read.groups.at(0).joints == Names{"j3", "j5"});
    CHECK(read.warnings ==
          Names{"a.srdf: <passive_joint> leaves j4 out of the groups of the SRDF, which do not "
                "plan for it"});
  }

  TEST_CASE("a group that names the root link has the virtual joint that carries it") {
    const Robot::Parts parts = applied(
        R"(<virtual_joint name="odom" type="planar" parent_frame="map" child_link="l0"/>
           <group name="all"><link name="l0"/><link name="l1"/></group>
           <group name="arm"><link name="l1"/></group>)");
    CHECK(parts.groups.at(0).virtual_joint == "odom");
    CHECK(parts.groups.at(0).joints == Names{"j1"});
    CHECK(parts.groups.at(1).virtual_joint.empty());
  }

  TEST_CASE("the parent frame of a fixed virtual joint is a name of the root link's frame") {
    const auto made = [](const std::string& type, const std::string& child) {
      return test::require_robot(applied("<virtual_joint name='v' type='" + type +
                                         "' parent_frame='world' child_link='" + child + "'/>"));
    };
    const Robot robot = made("fixed", "l0");
    CHECK(robot.root_frame() == "world");
    CHECK(robot.find_frame("world") == 0);
    CHECK(robot.find_frame("l1") == 1);
    CHECK_FALSE(robot.find_frame("").has_value());
    CHECK_FALSE(robot.find_link("world").has_value());
    CHECK(made("planar", "l0").root_frame().empty());
    CHECK(made("fixed", "l1").root_frame().empty());
    CHECK_FALSE(made("floating", "l0").find_frame("").has_value());
  }

  TEST_CASE("types of virtual joints and foreign attributes are tolerated by name") {
    for (const auto& [xml, what] :
         {std::pair("<virtual_joint name='v' type='revolute' parent_frame='w' child_link='l0'/>",
                    "<virtual_joint>: the type 'revolute', which counts as floating"),
          std::pair("<group name='g' color='red'><joint name='j1'/></group>",
                    "unknown attribute 'color' of <group>")}) {
      const std::string text = xml, finding = what;
      const Robot::Parts parts = applied(text);
      REQUIRE(parts.warnings.size() == 1);
      CHECK_MESSAGE(contains(parts.warnings[0], finding), parts.warnings[0]);
      Robot::Parts strict = test::make_chain(1);
      CHECK_FALSE(apply_srdf("<robot name='chain'>" + text + "</robot>", "a.srdf", strict, true)
                      .has_value());
    }
    Robot::Parts root = test::make_chain(1);
    REQUIRE(apply_srdf("<robot name='chain' author='me'/>", "a.srdf", root).has_value());
    CHECK(contains(root.warnings.at(0), "unknown attribute 'author' of <robot>"));
  }

  TEST_CASE("a state that contradicts a follower is named, and refused if strict") {
    const auto state = [](const std::string& value) {
      return "<robot name='chain'><group name='g'><joint name='j1'/></group>"
             "<group_state name='open' group='g'><joint name='j1' value='0.02'/>"
             "<joint name='j2' value='" +
             value + "'/></group_state></robot>";
    };
    Robot::Parts parts = test::make_chain(2);
    parts.joints[1].mimic = test::follow(0, 2, 0.1);
    Robot::Parts same = parts, strict = parts;
    REQUIRE(apply_srdf(state("0.14"), "a.srdf", same, true).has_value());
    CHECK(same.warnings.empty());
    REQUIRE(apply_srdf(state("0.03"), "a.srdf", parts).has_value());
    CHECK(parts.warnings == Names{"a.srdf:1: group_state 'open': joint 'j2' follows 'j1', which "
                                  "brings it to 0.14; its value 0.03 is ignored"});
    const auto refused = apply_srdf(state("0.03"), "a.srdf", strict, true);
    REQUIRE_FALSE(refused.has_value());
    CHECK(refused.error().message == parts.warnings[0]);
  }

  TEST_CASE("unknown names of every element are warnings, and errors if strict") {
    const std::string text = R"(<robot name="chain"><passive_joint name="a"/>
      <virtual_joint name="v" type="fixed" parent_frame="w" child_link="b"/>
      <group_state name="h" group="c"><joint name="j1" value="0"/></group_state>
      <end_effector name="e" parent_link="d" group="f"/></robot>)";
    Robot::Parts parts = test::make_chain(2);
    require(apply_srdf(text, "a.srdf", parts));
    CHECK(parts.warnings == Names{"a.srdf:1: robot 'chain' has no joint 'a'",
                                  "a.srdf:4: robot 'chain' has no link 'd'",
                                  "a.srdf:4: robot 'chain' has no group 'f'",
                                  "a.srdf:2: robot 'chain' has no link 'b'",
                                  "a.srdf:3: robot 'chain' has no group 'c'"});
    Robot::Parts strict = test::make_chain(2);
    CHECK(require_error(apply_srdf(text, "a.srdf", strict, true)).message == parts.warnings[0]);
  }

  TEST_CASE("foreign attributes and children of allowed pairs are tolerated by name") {
    const Robot::Parts parts = applied(
        R"(<disable_collisions link1="l0" link2="l1" reson="Never"><x/></disable_collisions>)");
    REQUIRE(parts.warnings.size() == 1);
    CHECK(contains(parts.warnings[0], "unknown attribute 'reson'"));
    CHECK(contains(parts.warnings[0], "<x> in <disable_collisions>"));
    CHECK(parts.allowed_pairs == LinkPairs{{"l0", "l1"}});
  }

  TEST_CASE("groups of end effectors are marked") {
    const Robot::Parts parts = applied(R"(<group name="hand"><joint name="j5"/></group>
      <group name="arm"><joint name="j1"/></group>
      <end_effector name="e" parent_link="l4" group="hand"/>)");
    CHECK(parts.groups.at(0).is_end_effector);
    CHECK_FALSE(parts.groups.at(1).is_end_effector);
    CHECK(test::require_robot(parts).group_joint(0).name == "j1");
  }

  TEST_CASE("only disabled pairs may touch, neighbours or not") {
    CHECK(pairs_of(applied("", test::make_chain(2))) ==
          std::vector<std::pair<int, int>>{{0, 1}, {0, 2}, {1, 2}});
    CHECK(pairs_of(applied(R"(<disable_collisions link1="l1" link2="l0" reason="Adjacent"/>
                              <disable_collisions link1="l0" link2="l1"/>)",
                           test::make_chain(2))) ==
          std::vector<std::pair<int, int>>{{0, 2}, {1, 2}});
  }

  TEST_CASE("a link that may touch all may not touch those it is enabled for") {
    const Robot::Parts parts = applied(R"(<disable_default_collisions link="l1"/>
      <enable_collisions link1="l1" link2="l2"/>)",
                                       test::make_chain(2));
    CHECK(parts.allowed_pairs == LinkPairs{{"l0", "l1"}});
  }

  TEST_CASE("names that the robot lacks are left aside with one warning each") {
    const Robot::Parts parts = applied(R"(<group name="g"><joint name="elbow"/><joint name="j1"/>
      <group name="nobody"/><chain base_link="l0" tip_link="hand"/></group>
      <disable_collisions link1="l0" link2="wheel"/>
      <disable_collisions link1="wheel" link2="l1"/>)");
    CHECK(parts.groups.at(0).joints == Names{"j1"});
    CHECK(parts.allowed_pairs == LinkPairs());
    CHECK(parts.warnings == Names{"a.srdf:2: robot 'chain' has no joint 'elbow'",
                                  "a.srdf:3: robot 'chain' has no link 'hand'",
                                  "a.srdf:3: robot 'chain' has no group 'nobody'",
                                  "a.srdf:4: robot 'chain' has no link 'wheel'"});
    const Robot robot = test::require_robot(parts);
    CHECK(Names(robot.warnings().begin(), robot.warnings().end()) == parts.warnings);
  }

  TEST_CASE("an SRDF for another robot is used with a warning") {
    Robot::Parts parts = test::make_chain(1);
    CHECK(apply_srdf("<robot name=\"other\"/>", "a.srdf", parts).has_value());
    CHECK(parts.warnings == Names{"a.srdf:1: this SRDF is for robot 'other', not for 'chain'"});
  }

  TEST_CASE("a malformed SRDF is an error") {
    Robot::Parts parts = test::make_chain(1);
    const Error fault =
        require_error(apply_srdf("<robot name=\"chain\"><group/></robot>", "a.srdf", parts));
    CHECK(contains(fault.message, "a.srdf:1: <group>"));
  }
}

}  // namespace mneme
