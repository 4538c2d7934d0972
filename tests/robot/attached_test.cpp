// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/small_robots.h"
#include "support/support.h"

#include <doctest/doctest.h>

namespace mneme::test {
namespace {

ApproximatedObject ball(const std::string& name, const std::string& link,
                        std::vector<std::string> may_touch = {}) {
  const Sphere sphere{{0.1, 0, 0}, 0.2};
  return {{name, link, {sphere}, {}, std::move(may_touch)}, {sphere}, {}};
}

Robot carrying(const Robot& robot, std::vector<ApproximatedObject> objects) {
  return require(robot.with_attached(std::move(objects)));
}

using Pairs = std::vector<std::pair<int, int>>;

/// Self pairs whose second link is `first` or later.
Pairs pairs_from(const Robot& robot, int first) {
  Pairs pairs;
  for (const auto& pair : robot.self_pairs()) {
    if (pair.second >= first) pairs.push_back(pair);
  }
  return pairs;
}

std::string refusal(const Robot& robot, const ApproximatedObject& object) {
  const Error error = require_error(robot.with_attached({object}));
  CHECK(error.code == ErrorCode::invalid);
  return error.message;
}

TEST_SUITE("unit") {
  TEST_CASE("an attached object is a link that its carrier moves") {
    const Robot bare = require_robot(make_chain(4));
    const Robot robot = carrying(bare, {ball("cup", "l3")});
    REQUIRE(robot.links().size() == bare.links().size() + 1);
    CHECK(robot.links().back().name == "cup");
    CHECK(robot.attached().size() == 1);
    CHECK(robot.is_attached(robot.attached()[0].object.name));
    CHECK(!robot.is_attached(robot.links().front().name));
    CHECK(bare.attached().empty());
    const Configuration q = {0.1, 0.2, 0.3, 0.4};
    const std::vector<Transform> poses = robot.link_poses(q);
    CHECK(poses.back().translation == poses[3].translation);
    CHECK(poses.back().rotation == poses[3].rotation);
    CHECK(poses[4].translation == bare.link_poses(q)[4].translation);
  }

  TEST_CASE(
      "it is checked against all links that move against it, except those that may touch it") {
    const Robot bare = require_robot(make_chain(4));
    const int cup = static_cast<int>(bare.links().size());
    const std::size_t own = bare.self_pairs().size();
    CHECK(pairs_from(carrying(bare, {ball("cup", "l3")}), cup) ==
          Pairs{{0, cup}, {1, cup}, {2, cup}, {4, cup}});
    CHECK(pairs_from(carrying(bare, {ball("cup", "l3", {"l4", "l0"})}), cup) ==
          Pairs{{1, cup}, {2, cup}});
    CHECK(carrying(bare, {ball("cup", "l3")}).self_pairs().size() == own + 4);
  }

  TEST_CASE("objects are checked against each other, unless one link carries both") {
    const Robot bare = require_robot(make_chain(4));
    const int cup = static_cast<int>(bare.links().size()), lid = cup + 1;
    const auto has_pair = [&](const Robot& robot) {
      const Pairs pairs = pairs_from(robot, lid);
      return std::ranges::count(pairs, std::pair(cup, lid)) > 0;
    };
    CHECK(has_pair(carrying(bare, {ball("cup", "l3"), ball("lid", "l1")})));
    CHECK(!has_pair(carrying(bare, {ball("cup", "l3"), ball("lid", "l3")})));
    CHECK(!has_pair(carrying(bare, {ball("cup", "l3", {"lid"}), ball("lid", "l1")})));
    CHECK(!has_pair(carrying(bare, {ball("cup", "l3"), ball("lid", "l1", {"cup"})})));
    CHECK(has_pair(carrying(carrying(bare, {ball("cup", "l3")}), {ball("lid", "l1")})));
  }

  TEST_CASE("experience of the bare robot is that of the robot with objects") {
    const Robot bare = require_robot(make_chain(4));
    CHECK(carrying(bare, {ball("cup", "l3")}).hash() == bare.hash());
  }

  TEST_CASE("objects are let go one by one, or all") {
    const Robot bare = require_robot(make_chain(4));
    const Robot both = carrying(bare, {ball("cup", "l3", {"lid"}), ball("lid", "l1")});
    const auto without_lid = require(both.without_attached("lid"));
    REQUIRE(without_lid.attached().size() == 1);
    CHECK(without_lid.attached()[0].object.name == "cup");
    CHECK(without_lid.attached()[0].object.may_touch.empty());
    CHECK(without_lid.without_attached("cup")->links().size() == bare.links().size());
    CHECK(both.without_attached().identity().lock() == bare.identity().lock());
    CHECK(both.without_attached("cap").error().message == "robot 'chain' carries no object 'cap'");
  }

  TEST_CASE("a planar arm stays planar while what it carries lies in its plane") {
    const Robot bare = planar8();
    REQUIRE(bare.is_planar());
    CHECK(carrying(bare, {ball("cup", "link_8")}).is_planar());
    ApproximatedObject above = ball("cup", "link_8");
    above.spheres[0].center.z() = 0.1;
    CHECK(!carrying(bare, {above}).is_planar());
  }

  TEST_CASE("10,000 objects are carried, unless their pairs are too many") {
    const Robot bare = require_robot(make_chain(4));
    const auto balls = [](int count, int carriers) {
      std::vector<ApproximatedObject> objects;
      for (int i = 0; i < count; ++i) {
        objects.push_back(ball("ball" + std::to_string(i), "l" + std::to_string(1 + i % carriers)));
      }
      return objects;
    };
    const Robot robot = carrying(bare, balls(10000, 1));
    CHECK(robot.self_pairs().size() >= 20000);
    const Error refused = require_error(bare.with_attached(balls(2000, 4)));
    CHECK(refused.code == ErrorCode::unsupported);
    CHECK(refused.message.ends_with("an object may have many shapes"));
  }

  TEST_CASE("objects that nothing can carry are refused by name") {
    const Robot bare = require_robot(make_chain(4));
    CHECK(refusal(bare, ball("cup", "hand")) ==
          "attached object 'cup': there is no link 'hand' to carry it");
    CHECK(refusal(bare, ball("l2", "l3")) ==
          "attached object 'l2': there is a link or another attached object of this name");
    CHECK(refusal(carrying(bare, {ball("cup", "l1")}), ball("cup", "l3")) ==
          "attached object 'cup': there is a link or another attached object of this name");
    CHECK(refusal(bare, ball("", "l3")) == "attached object '': it has no name");
    CHECK(refusal(bare, ball("cup", "l3", {"thumb"})) ==
          "attached object 'cup': it may touch 'thumb', but no link or attached object has this "
          "name");
    CHECK(
        refusal(bare, {{"cup", "l3", {Sphere{}}}, {}, {}}) ==
        "attached object 'cup': it has no spheres and no capsules; approximate_object makes them");
    ApproximatedObject inverted = ball("cup", "l3");
    inverted.spheres[0].radius = -0.1;
    CHECK(refusal(bare, inverted) ==
          "attached object 'cup': a sphere has the radius -0.1, expected 0 to 1e6");
    inverted = ball("cup", "l3");
    inverted.capsules.push_back({Vec3::Zero(), {std::nan(""), 0, 0}, 0.1});
    CHECK(refusal(bare, inverted) ==
          "attached object 'cup': an end of a capsule is not within 1000000 m");
  }
}

}  // namespace
}  // namespace mneme::test
