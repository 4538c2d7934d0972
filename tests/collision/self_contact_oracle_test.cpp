// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Contacts of whole robots with themselves, against FCL on their exact geometry. MNEME_ROBOTS may
// name more URDF files, separated by colons.
#include "mneme/collision.h"
#include "mneme/spheres.h"

#include "collision/fcl_robot.h"
#include "collision/random_worlds.h"

#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

namespace mneme::test {
namespace {

std::vector<std::string> robot_files() {
  std::vector<std::string> files;
  for (const char* name : {"source/ur5", "panda", "fetch"}) {
    files.push_back(source_file(std::string("robots/") + name + ".urdf"));
  }
  const char* more = std::getenv("MNEME_ROBOTS");
  std::istringstream names(more == nullptr ? "" : more);
  for (std::string name; std::getline(names, name, ':');) files.push_back(name);
  return files;
}

void check_contacts(const std::string& path) {
  INFO(path);
  const auto loaded = require(load_approximated_robot(path));
  const Robot& robot = loaded.robot;
  FclRobot oracle(robot);
  const std::vector<LinkPair> pairs = require(pairs_to_check(path, robot, oracle));
  const CollisionChecker checker = require_checker(robot, Scene{});
  Rng rng(7);
  const std::vector<float> rows = random_states(robot, rounds(300), rng);
  const std::vector<std::uint8_t> is_valid = check_all(checker, rows);
  int touching = 0, free = 0;
  for (std::size_t i = 0; i < is_valid.size(); ++i) {
    const auto q = row(rows, i, robot);
    oracle.move_to(Configuration(q.begin(), q.end()));
    const LinkPair* found = oracle.touching(pairs);
    touching += found != nullptr ? 1 : 0;
    free += is_valid[i];
    if (found == nullptr) continue;
    INFO("state " << i << ": " << robot.links()[static_cast<std::size_t>(found->first)].name
                  << " and " << robot.links()[static_cast<std::size_t>(found->second)].name);
    CHECK(is_valid[i] == 0);
  }
  CHECK(free > 0);
  CHECK(touching > 0);
  MESSAGE(path << ": " << pairs.size() << " pairs, " << robot.exact_pairs().size()
               << " by exact geometry; of " << is_valid.size() << " states " << touching
               << " touch in FCL, " << free << " are valid");
}

/// A camera on a bracket beside the wrist, which folds towards the forearm.
const std::string kTool = R"(<robot name="tool">
  <link name="base"/>
  <link name="fore"><collision><origin xyz="0 0 0.2"/>
    <geometry><box size="0.06 0.06 0.36"/></geometry></collision></link>
  <link name="wrist"><collision><origin xyz="0 0 0.04"/>
    <geometry><box size="0.05 0.05 0.06"/></geometry></collision></link>
  <link name="camera"><collision>
    <geometry><box size="0.04 0.04 0.12"/></geometry></collision></link>
  <joint name="j1" type="revolute"><parent link="base"/><child link="fore"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
  <joint name="j2" type="revolute"><parent link="fore"/><child link="wrist"/>
    <origin xyz="0 0 0.4"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
  <joint name="mount" type="fixed"><parent link="wrist"/><child link="camera"/>
    <origin xyz="0.07 0 0.06"/></joint>
</robot>)";

TEST_SUITE("oracle") {
  TEST_CASE("no contact of a robot with itself is missed") {
    for (const std::string& path : robot_files()) check_contacts(path);
  }

  TEST_CASE("no contact of a link that is fixed to a wrist is missed") {
    const TemporaryDirectory files;
    write_file(files / "tool.urdf", kTool);
    check_contacts(files / "tool.urdf");
  }
}

}  // namespace
}  // namespace mneme::test
