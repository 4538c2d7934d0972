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

TEST_SUITE("oracle") {
  TEST_CASE("no contact of a robot with itself is missed") {
    for (const std::string& path : robot_files()) {
      INFO(path);
      const auto loaded = require(load_approximated_robot(path));
      const Robot& robot = loaded.robot;
      const auto found_pairs = require(pairs_to_check(path, robot));
      const std::vector<LinkPair>& pairs = found_pairs;
      const CollisionChecker checker = require_checker(robot, Scene{});
      FclRobot oracle(robot);
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
      MESSAGE(path << ": " << pairs.size() << " pairs, " << robot.exact_pairs().size()
                   << " by exact geometry; of " << is_valid.size() << " states " << touching
                   << " touch in FCL, " << free << " are valid");
    }
  }
}

}  // namespace
}  // namespace mneme::test
