// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/spheres.h"

#include "spheres/approximate_robot.h"
#include "spheres/small_parts.h"
#include "spheres/solids.h"
#include "support/support.h"

#include <map>

namespace mneme::test {
namespace {

using Reasons = std::map<std::string, AllowedReason>;

Reasons reasons_of(const Robot::Parts& parts, const PairSettings& settings = {}) {
  const auto pairs = require(derive_allowed_pairs(parts, settings));
  Reasons reasons;
  for (const AllowedPair& pair : pairs) reasons[pair.first + " " + pair.second] = pair.reason;
  CHECK(reasons.size() == pairs.size());
  return reasons;
}

Robot::Parts make_balls(int joint_count, double radius) {
  Robot::Parts parts = make_bare_chain(joint_count);
  for (Link& link : parts.links) link.spheres = {{{0, 0, 0}, radius}};
  return parts;
}

TEST_SUITE("unit") {
  TEST_CASE("neighbours are adjacent, also where they never touch") {
    const Reasons reasons = reasons_of(make_balls(1, 0.1));
    CHECK(reasons == Reasons{{"l0 l1", AllowedReason::adjacent}});
  }

  TEST_CASE("pairs that cannot meet are never in contact, pairs that can are not allowed") {
    // l0 and l2 are 2 cos(q / 2) apart, at least 1.08; l3 can come back to l0.
    const Reasons reasons = reasons_of(make_balls(3, 0.3));
    CHECK(reasons.at("l0 l2") == AllowedReason::never);
    CHECK(reasons.at("l1 l3") == AllowedReason::never);
    CHECK_FALSE(reasons.contains("l0 l3"));
    CHECK(reasons.size() == 5);
  }

  TEST_CASE("pairs that cannot part are always in contact") {
    CHECK(reasons_of(make_balls(2, 1.1)).at("l0 l2") == AllowedReason::always);
  }

  TEST_CASE("contact at rest is allowed only if asked for") {
    Robot::Parts parts = make_balls(2, 0.1);
    // Straight ahead, the tip of l2 lies beside l0's far end.
    parts.links[0].spheres = {{{2.2, 0, 0}, 0.3}};
    CHECK_FALSE(reasons_of(parts).contains("l0 l2"));
    CHECK(reasons_of(parts, {10000, true, 1}).at("l0 l2") == AllowedReason::at_rest);
  }

  TEST_CASE("links that are welded together are adjacent, their neighbours are not") {
    Robot::Parts parts = make_balls(3, 0.3);
    parts.joints[1].type = JointType::fixed;
    const Reasons reasons = reasons_of(parts);
    CHECK(reasons.at("l0 l1") == AllowedReason::adjacent);
    CHECK(reasons.at("l1 l2") == AllowedReason::adjacent);
    CHECK(reasons.at("l0 l2") == AllowedReason::never);
    CHECK(reasons.at("l1 l3") == AllowedReason::never);
    // A camera on the wrist l1 that the forearm l0 can meet.
    parts.joints[1].origin.translation = Vec3(-0.5, 0.6, 0);
    CHECK_FALSE(reasons_of(parts).contains("l0 l2"));
    // Its mount is around the wrist.
    parts.joints[0].origin.translation = Vec3(0.4, 0, 0);
    parts.joints[1].origin.translation = Vec3(0.1, 0, 0);
    CHECK(reasons_of(parts).at("l0 l2") == AllowedReason::always);
  }

  TEST_CASE("a link without shapes passes adjacency on to the link above it") {
    Robot::Parts parts = make_balls(2, 1.1);
    parts.links[1].spheres.clear();
    CHECK(reasons_of(parts) == Reasons{{"l0 l2", AllowedReason::adjacent}});
  }

  TEST_CASE("by exact geometry, spheres that stick out into each other are no contact") {
    // Two plates of 2 cm, the second 5 cm above the first, each in a sphere of 40 cm.
    Robot::Parts parts = make_bare_chain(2);
    parts.joints[1].origin.translation = Vec3(0, 0, 0.05);
    parts.joints[0].origin.translation = Vec3::Zero();
    for (const std::size_t link : {0, 2}) {
      parts.links[link].solids = {make_box({0.5, 0.5, 0.02})};
    }
    parts.links[1].spheres = {{{0, 0, 3}, 0.1}};
    const auto made = require(approximate_robot(parts, {0.3, 1, 0.3}));
    CHECK(reasons_of(made.parts).at("l0 l2") != AllowedReason::never);
    CHECK(reasons_of(made.parts, {.samples = 200, .is_exact = true}).at("l0 l2") ==
          AllowedReason::never);
  }

  TEST_CASE("fingers that slide along a common face are always in contact, rounded or not") {
    Robot::Parts parts = make_bare_chain(2);
    parts.joints[1].parent_link = 0;
    for (Joint& joint : parts.joints) {
      joint.type = JointType::prismatic;
      joint.axis = Vec3::UnitY();
      joint.origin.translation = Vec3::Zero();
      joint.lower = 0;
      joint.upper = 0.02;
    }
    constexpr double kRounding = 1e-9;
    const Vec3 extents(0.01, 0.05, 0.017);
    parts.links[1].solids = {make_box(extents, Vec3(-0.005 - kRounding, 0, 0))};
    parts.links[2].solids = {make_box(extents, Vec3(0.005, 0, 0))};
    const auto made = approximate_robot(parts);
    REQUIRE(made.has_value());
    CHECK(reasons_of(made->parts, {.samples = 200, .is_exact = true}).at("l1 l2") ==
          AllowedReason::always);
    const Robot robot = require(make_robot(made->parts));
    CHECK(internal::find_inseparable_pairs(robot).always.size() == 1);
  }

  TEST_CASE("reasons have the words of an SRDF") {
    CHECK(to_string(AllowedReason::adjacent) == "Adjacent");
    CHECK(to_string(AllowedReason::always) == "Always");
    CHECK(to_string(AllowedReason::never) == "Never");
    CHECK(to_string(AllowedReason::at_rest) == "Default");
  }

  TEST_CASE("no samples, no joints and no tree are errors") {
    CHECK_FALSE(derive_allowed_pairs(make_balls(1, 0.1), {0, false, 1}).has_value());
    CHECK_FALSE(derive_allowed_pairs(make_balls(0, 0.1)).has_value());
    Robot::Parts loop = make_balls(2, 0.1);
    loop.joints[0].parent_link = 2;
    CHECK_FALSE(derive_allowed_pairs(loop).has_value());
  }
}

TEST_SUITE("law") {
  TEST_CASE("the same seed gives the same pairs, and more samples allow no more") {
    Rng rng(4);
    Robot::Parts parts = make_bare_chain(6);
    for (Link& link : parts.links) link.spheres = {{0.4 * random_point(rng, 1), 0.3}};
    const Reasons few = reasons_of(parts, {50, false, 1});
    CHECK(few == reasons_of(parts, {50, false, 1}));
    const Reasons many = reasons_of(parts, {5000, false, 1});
    CHECK(many.size() < few.size());
    for (const auto& [pair, reason] : many) CHECK(few.at(pair) == reason);
  }
}

/// Two links in line, each a ball at its joint; a ring of `radius` about the last one's axis.
Robot arm_with_ring(double radius) {
  Robot::Parts parts;
  parts.name = "ringed";
  parts.links.resize(3);
  parts.links[0] = {.name = "base", .spheres = {{Vec3(0, 0, 0), 0.1}}};
  parts.links[1] = {"arm", 0, {{Vec3(0.5, 0, 0), 0.1}}, {}, {}};
  parts.links[2] = {"ring", 1, {{Vec3(radius, 0, 0), 0.1}}, {}, {}};
  parts.allowed_pairs.emplace();
  for (int i = 0; i < 2; ++i) {
    Joint joint;
    joint.name = i == 0 ? "swing" : "spin";
    joint.type = JointType::revolute;
    joint.parent_link = i;
    joint.child_link = i + 1;
    joint.origin.translation = Vec3(0.5 * i, 0, 0);
    joint.axis = i == 0 ? Vec3(Vec3::UnitZ()) : Vec3(Vec3::UnitX());
    joint.lower = -2;
    joint.upper = 2;
    parts.joints.push_back(joint);
  }
  return require(make_robot(std::move(parts)));
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("links that touch however the joints turn are found") {
    const auto pairs = internal::find_inseparable_pairs(arm_with_ring(0.05));
    REQUIRE(pairs.always.size() == 1);
    CHECK(pairs.always.front() == std::pair<std::string, std::string>("arm", "ring"));
    CHECK(pairs.only_spheres.empty());
  }

  TEST_CASE("links that part in some configuration are not") {
    CHECK(internal::find_inseparable_pairs(arm_with_ring(0.3)).always.empty());
  }

  TEST_CASE("a robot whose links never touch has none") {
    CHECK(internal::find_inseparable_pairs(planar8()).always.empty());
  }
}

}  // namespace mneme::test
