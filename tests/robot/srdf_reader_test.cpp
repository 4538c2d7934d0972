// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/small_robots.h"
#include "robot/srdf.h"
#include "support/support.h"

#include <string>
#include <vector>

namespace mneme {
namespace {

using internal::read_srdf;
using internal::Srdf;
using test::contains;

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
    const auto srdf = read_srdf(kSrdf, "arm.srdf");
    REQUIRE(srdf.has_value());
    CHECK(srdf->robot.name == "arm");
    REQUIRE(srdf->groups.size() == 2);
    const internal::SrdfGroup& all = srdf->groups[0];
    CHECK(all.name.name == "all");
    CHECK(all.joints.at(0).name == "j1");
    CHECK(all.joints.at(0).line == 5);
    CHECK(all.links.at(0).name == "l2");
    CHECK(all.chains.at(0).first.name == "l0");
    CHECK(all.chains.at(0).second.name == "l3");
    CHECK(all.subgroups.at(0).name == "hand");
    CHECK(srdf->end_effectors.at(0).name == "hand");
    CHECK(srdf->virtual_joints.at(0).name == "world");
    CHECK(srdf->passive_joints.at(0).name == "wheel");
    CHECK(srdf->disabled.at(0).second.name == "l1");
    CHECK(srdf->disabled.at(0).second.line == 16);
    CHECK(srdf->disabled_links.at(0).name == "l2");
    CHECK(srdf->enabled.at(0).first.name == "l2");
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
        {"<!-- a comment -->", "stray", 3, "<robot>: text"},
    };
    for (const Malformed& c : cases) {
      CAPTURE(c.to);
      std::string text = kSrdf;
      const std::size_t at = text.find(c.from);
      REQUIRE_MESSAGE(at != std::string::npos, c.from);
      const auto srdf = read_srdf(text.replace(at, c.from.size(), c.to), "arm.srdf");
      REQUIRE_FALSE(srdf.has_value());
      const std::string& message = srdf.error().message;
      CHECK_MESSAGE(message.starts_with("arm.srdf:" + std::to_string(c.line) + ": "), message);
      CHECK_MESSAGE(contains(message, c.part), message);
      CHECK(srdf.error().code == ErrorCode::parse);
    }
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

}  // namespace mneme
