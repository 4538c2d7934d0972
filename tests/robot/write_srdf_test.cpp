// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/small_robots.h"
#include "robot/srdf.h"
#include "support/support.h"

#include <string>
#include <vector>

namespace mneme {
namespace {

using test::contains;

Robot::Parts parts_with_groups() {
  Robot::Parts parts = test::make_chain(3);
  parts.name = "a & b";
  parts.groups = {{"arm", {"j1", "j2"}}, {"hand", {"j3"}, true}, {"tool", {}, true}};
  parts.allowed_pairs.emplace();
  parts.allowed_pairs->emplace_back("l0", "l1");
  parts.allowed_pairs->emplace_back("l1", "l2");
  return parts;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("groups, end effectors and allowed pairs read back the same") {
    const Robot::Parts parts = parts_with_groups();
    Robot::Parts read = test::make_chain(3);
    read.name = parts.name;
    const auto fault = internal::apply_srdf(to_srdf(parts), "text", read);
    REQUIRE_MESSAGE(!fault, (fault ? fault->message : ""));
    CHECK(read.warnings.empty());
    CHECK(read.allowed_pairs == parts.allowed_pairs);
    CHECK(test::require_robot(read).hash() == test::require_robot(parts).hash());
    REQUIRE(read.groups.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(read.groups[i].name == parts.groups[i].name);
      CHECK(read.groups[i].joints == parts.groups[i].joints);
      CHECK(read.groups[i].is_end_effector == parts.groups[i].is_end_effector);
    }
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
    CHECK_FALSE(internal::apply_srdf(to_srdf(test::make_chain(2)), "text", read).has_value());
    CHECK(read.groups.empty());
    CHECK(read.allowed_pairs.value().empty());
  }
}

}  // namespace mneme
