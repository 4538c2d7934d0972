// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/robot_facts.h"
#include "robot/small_robots.h"
#include "support/support.h"

#include <functional>
#include <string>
#include <vector>

namespace mneme {
namespace {

using test::plan_for;

struct Change {
  std::string what;
  std::function<void(Robot::Parts&)> apply;
};

std::string hash_after(const Change& change) {
  Robot::Parts parts = test::make_chain(4);
  parts.links[1].capsules.push_back({Vec3::Zero(), Vec3(0.5, 0, 0), 0.05});
  change.apply(parts);
  return test::require_robot(parts).hash();
}

const Change kNothing{"nothing", [](Robot::Parts&) {}};

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a hash is 16 hexadecimal digits") {
    const std::string hash = test::planar8().hash();
    CHECK(hash.size() == 16);
    CHECK(hash.find_first_not_of("0123456789abcdef") == std::string::npos);
  }
}

TEST_SUITE("law") {
  TEST_CASE("names, signed zeros and the last bits of a number do not count") {
    const std::vector<Change> changes{
        {"names",
         [](Robot::Parts& p) {
           p.name = "other";
           for (Link& link : p.links) link.name += "_renamed";
           for (Joint& joint : p.joints) joint.name += "_renamed";
         }},
        {"signed zeros",
         [](Robot::Parts& p) {
           p.joints[0].origin.translation.y() = -0.0;
           p.links[0].spheres[0].center.z() = -0.0;
         }},
        {"last bits", [](Robot::Parts& p) { p.joints[1].origin.translation.z() = 1e-16; }},
        {"length of an axis", [](Robot::Parts& p) { p.joints[1].axis *= 3; }},
    };
    for (const Change& change : changes) {
      CAPTURE(change.what);
      CHECK(hash_after(change) == hash_after(kNothing));
    }
  }

  TEST_CASE("whatever decides about validity counts") {
    const std::vector<Change> changes{
        {"limit", [](Robot::Parts& p) { p.joints[2].upper += 1e-6; }},
        {"radius of a sphere", [](Robot::Parts& p) { p.links[2].spheres[0].radius += 1e-6; }},
        {"centre of a sphere", [](Robot::Parts& p) { p.links[2].spheres[0].center.y() = 1e-6; }},
        {"one shape more", [](Robot::Parts& p) { p.links[3].spheres.push_back({}); }},
        {"end of a capsule", [](Robot::Parts& p) { p.links[1].capsules[0].b.x() += 1e-6; }},
        {"radius of a capsule", [](Robot::Parts& p) { p.links[1].capsules[0].radius += 1e-6; }},
        {"origin", [](Robot::Parts& p) { p.joints[2].origin.translation.x() += 1e-6; }},
        {"orientation",
         [](Robot::Parts& p) {
           p.joints[2].origin.rotation = rotation_from_rpy(Vec3(1e-6, 0, 0));
         }},
        {"axis", [](Robot::Parts& p) { p.joints[2].axis = -p.joints[2].axis; }},
        {"type", [](Robot::Parts& p) { p.joints[2].type = JointType::prismatic; }},
        {"following", [](Robot::Parts& p) { p.joints[3].mimic = test::follow(0); }},
        {"parent", [](Robot::Parts& p) { p.joints[3].parent_link = 2; }},
    };
    for (const Change& change : changes) {
      CAPTURE(change.what);
      CHECK(hash_after(change) != hash_after(kNothing));
    }
  }

  TEST_CASE("the group, its order and the fixed values count") {
    const auto hash = [](const RobotOptions& options) {
      return test::require_robot(test::make_chain(3), options).hash();
    };
    const std::string all = hash(plan_for({"j1", "j2", "j3"}));
    CHECK(all == hash({}));
    CHECK(all != hash(plan_for({"j2", "j1", "j3"})));
    const std::string two = hash(plan_for({"j1", "j2"}));
    CHECK(two != all);
    CHECK(two == hash(plan_for({"j1", "j2"}, {{"j3", 0.0}})));
    CHECK(two != hash(plan_for({"j1", "j2"}, {{"j3", 0.5}})));
  }

  TEST_CASE("whom a joint follows and how counts, unless it stands still") {
    const auto hash = [](int joint, double multiplier, double offset,
                         const std::vector<std::string>& group) {
      Robot::Parts parts = test::make_chain(4);
      parts.joints[3].mimic = test::follow(joint, multiplier, offset);
      return test::require_robot(parts, plan_for(group)).hash();
    };
    const std::vector<std::string> group{"j1", "j2", "j3"};
    CHECK(hash(0, 1, 0, group) != hash(1, 1, 0, group));
    CHECK(hash(0, 1, 0, group) != hash(0, -1, 0, group));
    CHECK(hash(0, 1, 0, group) != hash(0, 1, 0.5, group));
    CHECK(hash(0, 1, 0.5, {"j2"}) == hash(2, -1, 0.5, {"j2"}));
  }

  TEST_CASE("the pairs that are checked count") {
    const Robot robot = test::require_robot(test::make_chain(3));
    const std::vector<std::pair<int, int>> none;
    CHECK(internal::hash_robot(robot.links(), robot.joints(), robot.group(), none) != robot.hash());
    CHECK(internal::hash_robot(robot.links(), robot.joints(), robot.group(), robot.self_pairs()) ==
          robot.hash());
  }
}

}  // namespace mneme
