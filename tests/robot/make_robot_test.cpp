// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/robot_tree.h"
#include "robot/small_robots.h"
#include "support/support.h"

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace mneme {
namespace {

using test::contains;
using test::kPi;
using test::make_chain;
using test::plan_for;
using test::refusal;
using test::require_error;

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("without names the group is all movable joints in tree order") {
    Robot::Parts parts = make_chain(4);
    parts.joints[1].type = JointType::fixed;
    std::swap(parts.joints[0], parts.joints[3]);
    const Robot robot = test::require_robot(parts);
    CHECK(std::vector<int>(robot.group().begin(), robot.group().end()) == std::vector{0, 2, 3});
    CHECK(robot.joint_count() == 3);
    CHECK(robot.group_joint(1).name == "j3");
  }

  TEST_CASE("named joints become the group in the order of their names") {
    const Robot robot = test::require_robot(make_chain(3), plan_for({"j3", "j1"}));
    REQUIRE(robot.joint_count() == 2);
    CHECK(robot.group_joint(0).name == "j3");
    CHECK(robot.group_joint(1).name == "j1");
  }

  TEST_CASE("joints outside the group stand at zero or at the limit next to it") {
    Robot::Parts parts = make_chain(4);
    parts.joints[0].lower = 0.5;
    parts.joints[3].type = JointType::continuous;
    const Robot robot =
        test::require_robot(parts, plan_for({"j3"}, {{"j2", 9.0}, {"j4", 2 * kPi + 0.5}}));
    CHECK(robot.joints()[0].fixed_value == 0.5);
    CHECK(robot.joints()[1].fixed_value == 9);
    CHECK(robot.joints()[3].fixed_value == doctest::Approx(0.5));
    REQUIRE(robot.warnings().size() == 1);
    CHECK(contains(robot.warnings()[0], "value 9 of joint 'j2' is outside its limits [-2, 2]"));
  }

  TEST_CASE("options that do not fit the robot are refused by name") {
    CHECK(contains(refusal(make_chain(2), plan_for({"elbow"})),
                   "'elbow'; the movable joints are: j1, j2"));
    CHECK(contains(refusal(make_chain(2), plan_for({"j1", "j1"})), "'j1' appears twice"));
    CHECK(contains(refusal(make_chain(2), plan_for({"j1"}, {{"j9", 0}})), "'j9'"));
    CHECK(
        contains(refusal(make_chain(2), plan_for({"j1"}, {{"j1", 0}})), "'j1' has a fixed value"));
    CHECK(
        contains(refusal(make_chain(2), plan_for({"j1"}, {{"j2", std::nan("")}})), "'j2' is nan"));
    Robot::Parts parts = make_chain(2);
    parts.joints[1].type = JointType::fixed;
    CHECK(contains(refusal(parts, plan_for({"j2"})), "'j2' is fixed"));
  }

  TEST_CASE("pairs that the options allow to touch are not checked") {
    RobotOptions options;
    options.allowed_pairs.emplace_back("l3", "l1");
    const Robot robot = test::require_robot(make_chain(3), options);
    CHECK(std::vector(robot.self_pairs().begin(), robot.self_pairs().end()) ==
          std::vector<std::pair<int, int>>{{0, 2}, {0, 3}});
    options.allowed_pairs.emplace_back("l3", "hand");
    CHECK(contains(refusal(make_chain(3), options), "there is no link 'hand'"));
  }

  TEST_CASE("links that still have solids are refused by name") {
    Robot::Parts parts = make_chain(2);
    parts.links[1].solids.push_back(Box{});
    const Error error = require_error(make_robot(parts));
    CHECK(error.code == ErrorCode::unsupported);
    CHECK(contains(error.message, "robot 'chain': link 'l1' has boxes, cylinders or meshes"));
    CHECK(contains(error.message, "`mneme robot spheres`"));
  }

  TEST_CASE("a robot that cannot move or is no tree is refused") {
    for (const RobotOptions& options : {RobotOptions(), plan_for({"elbow"})}) {
      CHECK(contains(refusal(make_chain(1, JointType::fixed), options), "no joint that can move"));
    }
    Robot::Parts parts = make_chain(2);
    parts.joints.pop_back();
    CHECK(contains(refusal(parts, {}), "several root links"));
  }
}

TEST_SUITE("unit") {
  TEST_CASE("a joint that follows the group must turn about z too") {
    Robot::Parts parts = test::make_chain(2);
    parts.joints[1].mimic = test::follow(0);
    CHECK(test::require_robot(parts).is_planar());
    parts.joints[1].axis = Vec3::UnitX();
    CHECK_FALSE(test::require_robot(parts).is_planar());
  }

  TEST_CASE("arms that turn about z with shapes in the plane are planar") {
    CHECK(test::planar8().is_planar());
    Robot::Parts parts = test::make_chain(3);
    parts.joints[1].axis = Vec3(0, 0, -1);
    parts.joints[2].origin.rotation = rotation_from_rpy(Vec3(0, 0, 0.7));
    CHECK(test::require_robot(parts).is_planar());
  }

  TEST_CASE("whatever leaves the plane makes a robot spatial") {
    const std::vector<std::function<void(Robot::Parts&)>> changes{
        [](Robot::Parts& p) { p.links[1].spheres[0].center.z() = 1e-6; },
        [](Robot::Parts& p) { p.links[0].spheres[0].center.z() = 1e-6; },
        [](Robot::Parts& p) {
          p.links[2].capsules.push_back({Vec3(0, 0, 0), Vec3(1, 0, 1), 0.1});
        },
        [](Robot::Parts& p) { p.joints[1].axis = Vec3(0, 1e-6, 1); },
        [](Robot::Parts& p) { p.joints[0].origin.rotation = rotation_from_rpy(Vec3(1e-6, 0, 0)); },
        [](Robot::Parts& p) { p.joints[1].origin.translation.z() = 0.1; },
        [](Robot::Parts& p) { p.joints[1].type = JointType::prismatic; },
    };
    for (std::size_t i = 0; i < changes.size(); ++i) {
      CAPTURE(i);
      Robot::Parts parts = test::make_chain(3);
      changes[i](parts);
      CHECK_FALSE(test::require_robot(parts).is_planar());
    }
  }

  TEST_CASE("a lift outside the group counts with its fixed value") {
    Robot::Parts parts = test::make_chain(2);
    parts.joints[0].type = JointType::prismatic;
    RobotOptions options;
    options.joints = {"j2"};
    CHECK(test::require_robot(parts, options).is_planar());
    options.fixed_values = {{"j1", 0.5}};
    CHECK_FALSE(test::require_robot(parts, options).is_planar());
  }
}

namespace {

using Pairs = std::vector<std::pair<int, int>>;

Pairs pairs_of(const Robot& robot) {
  return {robot.self_pairs().begin(), robot.self_pairs().end()};
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("in a chain all links but neighbours are checked") {
    CHECK(pairs_of(test::require_robot(test::make_chain(3))) == Pairs{{0, 2}, {0, 3}, {1, 3}});
  }

  TEST_CASE("links without shapes are in no pair") {
    Robot::Parts parts = test::make_chain(3);
    parts.links[0].spheres.clear();
    CHECK(pairs_of(test::require_robot(parts)) == Pairs{{1, 3}});
  }

  TEST_CASE("a fixed joint welds its links into one body, each with its own neighbours") {
    Robot::Parts parts = test::make_chain(4);
    parts.joints[1].type = JointType::fixed;
    // Bodies {0}, {1, 2}, {3}, {4}.
    CHECK(pairs_of(test::require_robot(parts)) ==
          Pairs{{0, 2}, {0, 3}, {0, 4}, {1, 3}, {1, 4}, {2, 4}});
  }

  TEST_CASE("a link that is fixed to a wrist is checked against the forearm") {
    Robot::Parts parts = test::make_chain(3);
    parts.joints[2].type = JointType::fixed;
    CHECK(pairs_of(test::require_robot(parts)) == Pairs{{0, 2}, {0, 3}, {1, 3}});
  }

  TEST_CASE("links are neighbours through links without shapes, unless two joints move between") {
    Robot::Parts parts = test::make_chain(4);
    parts.links[1].spheres.clear();
    CHECK(pairs_of(test::require_robot(parts)) == Pairs{{0, 2}, {0, 3}, {0, 4}, {2, 4}});
    parts.joints[0].type = JointType::fixed;
    CHECK(pairs_of(test::require_robot(parts)) == Pairs{{0, 3}, {0, 4}, {2, 4}});
    parts.joints[3].parent_link = 1;
    // Fingers 2, with 3 on it, and 4 of a palm without shapes.
    CHECK(pairs_of(test::require_robot(parts)) == Pairs{{0, 3}, {2, 4}, {3, 4}});
  }

  TEST_CASE("a joint outside the group keeps its links together") {
    const Robot robot = test::require_robot(test::make_chain(4), {.joints = {"j1", "j3", "j4"}});
    CHECK(pairs_of(robot) == Pairs{{0, 2}, {0, 3}, {0, 4}, {1, 3}, {1, 4}, {2, 4}});
  }

  TEST_CASE("joints that follow the group move their links too") {
    Robot::Parts parts = test::make_chain(4);
    parts.joints[1].mimic = test::follow(0);
    CHECK(pairs_of(test::require_robot(parts, test::plan_for({"j1"}))) ==
          Pairs{{0, 2}, {0, 3}, {0, 4}, {1, 3}, {1, 4}});
    parts.joints[1].mimic = test::follow(0, 0);
    CHECK(pairs_of(test::require_robot(parts, test::plan_for({"j1"}))) ==
          Pairs{{0, 2}, {0, 3}, {0, 4}});
  }

  TEST_CASE("with a list of allowed pairs neighbours are checked like others") {
    Robot::Parts parts = test::make_chain(3);
    parts.joints[2].type = JointType::fixed;
    parts.allowed_pairs.emplace();
    CHECK(pairs_of(test::require_robot(parts)) == Pairs{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}});
    parts.allowed_pairs->emplace_back("l2", "l0");
    CHECK(pairs_of(test::require_robot(parts)) == Pairs{{0, 1}, {0, 3}, {1, 2}, {1, 3}});
  }

  TEST_CASE("links on two branches are checked against each other") {
    Robot::Parts parts = test::make_chain(2);
    parts.joints[1].parent_link = 0;
    CHECK(pairs_of(test::require_robot(parts)) == Pairs{{1, 2}});
  }
}

namespace {

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

  TEST_CASE("shapes, fingers, tools, pairs and names do not count as kinematics") {
    const auto kinematics = [](const Change& change) {
      Robot::Parts parts = test::make_chain(4);
      change.apply(parts);
      return test::require_robot(parts, plan_for({"j1", "j2", "j3"})).kinematics_hash();
    };
    CHECK(kinematics(kNothing).size() == 16);
    const std::vector<Change> harmless{
        {"spheres", [](Robot::Parts& p) { p.links[2].spheres.clear(); }},
        {"a finger moved", [](Robot::Parts& p) { p.joints[3].origin.translation.x() = 0.3; }},
        {"a tool",
         [](Robot::Parts& p) {
           p.links.push_back(test::make_link("tool"));
           p.joints.push_back(test::make_joint("mount", JointType::fixed, 3, 5));
         }},
        {"a link above the root in the same place",
         [](Robot::Parts& p) {
           p.links.push_back(test::make_link("world"));
           p.joints.push_back(test::make_joint("stand", JointType::fixed, 5, 0));
           p.joints.back().origin = {};
         }},
        {"checked pairs", [](Robot::Parts& p) { p.allowed_pairs.emplace(); }},
        {"names", [](Robot::Parts& p) { p.name = "other"; }},
    };
    for (const Change& change : harmless) {
      CAPTURE(change.what);
      CHECK(kinematics(change) == kinematics(kNothing));
    }
    const std::vector<Change> limits{{"limit", [](Robot::Parts& p) { p.joints[1].upper += 1e-6; }}};
    CHECK(kinematics(limits[0]).substr(0, 8) == kinematics(kNothing).substr(0, 8));
    CHECK(kinematics(limits[0]).substr(8) != kinematics(kNothing).substr(8));
    const std::vector<Change> frames{
        {"origin", [](Robot::Parts& p) { p.joints[1].origin.translation.y() += 1e-6; }},
        {"axis", [](Robot::Parts& p) { p.joints[2].axis = Vec3::UnitX(); }},
        {"type", [](Robot::Parts& p) { p.joints[2].type = JointType::prismatic; }},
        {"parent", [](Robot::Parts& p) { p.joints[2].parent_link = 1; }},
        {"where the root stands",
         [](Robot::Parts& p) {
           p.links.push_back(test::make_link("world"));
           p.joints.push_back(test::make_joint("stand", JointType::fixed, 5, 0));
         }},
    };
    for (const Change& change : frames) {
      CAPTURE(change.what);
      CHECK(kinematics(change).substr(0, 8) != kinematics(kNothing).substr(0, 8));
    }
  }

  TEST_CASE("the order of the group and joints that follow it count as kinematics") {
    const auto kinematics = [](const RobotOptions& options, bool has_follower = false) {
      Robot::Parts parts = test::make_chain(3);
      if (has_follower) parts.joints[1].mimic = test::follow(0, 0.5, 0.1);
      return test::require_robot(parts, options).kinematics_hash();
    };
    const std::string two = kinematics(plan_for({"j1", "j3"}));
    CHECK(two != kinematics(plan_for({"j3", "j1"})));
    CHECK(two != kinematics(plan_for({"j1", "j2"})));
    CHECK(two != kinematics(plan_for({"j1", "j3"}, {{"j2", 0.5}})));
    CHECK(two != kinematics(plan_for({"j1", "j3"}), true));
  }

  TEST_CASE("limits beyond two turns are a warning that names joint and unit") {
    Robot::Parts parts = test::make_chain(2);
    CHECK(test::require_robot(parts).warnings().empty());
    parts.joints[1].upper = 180;
    const Robot robot = test::require_robot(parts);
    REQUIRE(robot.warnings().size() == 1);
    CHECK(contains(robot.warnings()[0], "joint 'j2': its limits [-2, 180]"));
    CHECK(contains(robot.warnings()[0], "radians"));
    parts.joints[1].type = JointType::prismatic;
    CHECK(test::require_robot(parts).warnings().empty());
  }

  TEST_CASE("a follower that is led beyond its own limits is a warning") {
    Robot::Parts parts = test::make_chain(2);
    parts.joints[1].mimic = test::follow(0);
    CHECK(test::require_robot(parts).warnings().empty());
    parts.joints[1].mimic = test::follow(0, -1.5);
    const Robot robot = test::require_robot(parts);
    REQUIRE(robot.warnings().size() == 1);
    CHECK(robot.warnings()[0] ==
          "joint 'j2' follows 'j1' from -3 to 3, beyond its own limits [-2, 2]: expected limits of "
          "'j1' that keep it within them");
    parts.joints[0].lower = -1;
    parts.joints[0].upper = 4.0 / 3;
    CHECK(test::require_robot(parts).warnings().empty());
  }

  TEST_CASE("the pairs that are checked count") {
    const Robot robot = test::require_robot(test::make_chain(3));
    const std::vector<std::pair<int, int>> none;
    CHECK(internal::hash_robot(robot.links(), robot.joints(), robot.group(), none) != robot.hash());
    CHECK(internal::hash_robot(robot.links(), robot.joints(), robot.group(), robot.self_pairs()) ==
          robot.hash());
  }

  TEST_CASE("pairs that are checked by exact geometry are some of those that are checked") {
    Robot::Parts parts = test::make_chain(4);
    const auto name = [&](std::size_t link) { return parts.links[link].name; };
    const Robot plain = test::require_robot(parts);
    REQUIRE(!plain.self_pairs().empty());
    CHECK(plain.exact_pairs().empty());
    const auto [first, second] = plain.self_pairs().front();
    // The second pair is not checked, because a joint joins its links.
    parts.exact_pairs = {{plain.links()[static_cast<std::size_t>(second)].name,
                          plain.links()[static_cast<std::size_t>(first)].name},
                         {name(0), name(1)}};
    const Robot robot = test::require_robot(parts);
    REQUIRE(robot.exact_pairs().size() == 1);
    CHECK(robot.exact_pairs()[0] == plain.self_pairs().front());
    CHECK(robot.hash() != plain.hash());
    parts.exact_pairs = {{name(0), "hand"}};
    CHECK(require_error(make_robot(parts))
              .message.ends_with("links '" + name(0) +
                                 "' and 'hand' are checked by exact geometry, but there "
                                 "is no link 'hand'"));
  }
}

}  // namespace mneme
