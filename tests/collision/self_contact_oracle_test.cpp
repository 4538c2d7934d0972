// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Contacts of whole robots with themselves, against FCL on their exact geometry. MNEME_ROBOTS may
// name more URDF files, separated by colons.
#include "mneme/collision.h"
#include "mneme/spheres.h"

#include "collision/random_worlds.h"
#include "geometry/fcl_shapes.h"

#include <fcl/narrowphase/collision.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace mneme::test {
namespace {

using Pair = std::pair<int, int>;

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

/// Exact geometry of a robot's links in FCL.
class FclRobot {
 public:
  explicit FclRobot(const Robot& robot) : robot_(robot) {
    for (const Link& link : robot.links()) {
      std::vector<Part>& parts = links_.emplace_back();
      const auto add = [&](const Shape& shape) {
        const fcl::CollisionObjectd object = std::visit(ToFcl{}, shape);
        parts.push_back({std::make_unique<fcl::CollisionObjectd>(object), object.getTransform()});
      };
      const auto approximated =
          static_cast<std::size_t>(link.approximation ? link.approximation->sphere_count : 0);
      for (std::size_t i = 0; i + approximated < link.spheres.size(); ++i) add(link.spheres[i]);
      const auto replaced =
          static_cast<std::size_t>(link.approximation ? link.approximation->capsule_count : 0);
      for (std::size_t i = 0; i + replaced < link.capsules.size(); ++i) add(link.capsules[i]);
      if (link.approximation) add(link.approximation->surface);
    }
  }

  void move_to(const Configuration& q) {
    const std::vector<Transform> poses = robot_.link_poses(q);
    for (std::size_t i = 0; i < links_.size(); ++i) {
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.linear() = poses[i].rotation;
      pose.translation() = poses[i].translation;
      for (const Part& part : links_[i]) {
        part.object->setTransform(pose * part.in_link);
        part.object->computeAABB();
      }
    }
  }

  [[nodiscard]] bool touch(const Pair& pair) const {
    for (const Part& a : links_[static_cast<std::size_t>(pair.first)]) {
      for (const Part& b : links_[static_cast<std::size_t>(pair.second)]) {
        if (!a.object->getAABB().overlap(b.object->getAABB())) continue;
        fcl::CollisionResultd result;
        if (fcl::collide(a.object.get(), b.object.get(), fcl::CollisionRequestd{}, result) > 0) {
          return true;
        }
      }
    }
    return false;
  }

 private:
  struct Part {
    std::unique_ptr<fcl::CollisionObjectd> object;
    Eigen::Isometry3d in_link;
  };
  const Robot& robot_;
  std::vector<std::vector<Part>> links_;
};

bool have_same_pose(const Robot& robot, const Pair& pair, const Configuration& q,
                    const Configuration& other) {
  const auto relative = [&](const Configuration& at) {
    const std::vector<Transform> poses = robot.link_poses(at);
    return poses[static_cast<std::size_t>(pair.first)].inverse() *
           poses[static_cast<std::size_t>(pair.second)];
  };
  const Transform a = relative(q), b = relative(other);
  return a.rotation.isApprox(b.rotation, 1e-9) && (a.translation - b.translation).norm() < 1e-9;
}

/// True if the robot warns that nothing parts two links.
bool always_touch(const Robot& robot, int a, int b) {
  const auto quoted = [&](int link) {
    return "'" + robot.links()[static_cast<std::size_t>(link)].name + "'";
  };
  const std::string text = quoted(a) + " and " + quoted(b) + " touch in every configuration";
  const auto warnings = robot.warnings();
  return std::any_of(warnings.begin(), warnings.end(), [&](const std::string& warning) {
    return warning.find(text) != std::string::npos;
  });
}

/// All pairs that move against each other but for those of an SRDF, or, without one, those that are
/// adjacent or always touch by exact geometry.
std::vector<Pair> pairs_to_check(const std::string& path, const Robot& robot) {
  const auto parts = read_robot(path);
  REQUIRE_MESSAGE(parts.has_value(), (parts ? "" : parts.error().message));
  std::set<Pair> allowed;
  const auto allow = [&](const std::string& first, const std::string& second) {
    const auto a = robot.find_link(first), b = robot.find_link(second);
    if (a && b) allowed.insert(std::minmax(*a, *b));
  };
  if (parts->allowed_pairs) {
    for (const auto& [first, second] : *parts->allowed_pairs) allow(first, second);
  } else {
    const auto made = approximate_robot(*parts);
    REQUIRE_MESSAGE(made.has_value(), (made ? "" : made.error().message));
    const auto derived = derive_allowed_pairs(made->parts);
    REQUIRE_MESSAGE(derived.has_value(), (derived ? "" : derived.error().message));
    for (const AllowedPair& pair : *derived) {
      if (pair.reason != AllowedReason::never) allow(pair.first, pair.second);
    }
  }
  Rng rng(3);
  const std::vector<float> rows = random_states(robot, 2, rng);
  const auto configuration = [&](std::size_t i) {
    const auto q = row(rows, i, robot);
    return Configuration(q.begin(), q.end());
  };
  std::vector<Pair> pairs;
  for (int a = 0; a < static_cast<int>(robot.links().size()); ++a) {
    for (int b = a + 1; b < static_cast<int>(robot.links().size()); ++b) {
      const bool is_still = have_same_pose(robot, {a, b}, configuration(0), configuration(1));
      if (!allowed.contains({a, b}) && !is_still && !always_touch(robot, a, b)) {
        pairs.emplace_back(a, b);
      }
    }
  }
  return pairs;
}

TEST_SUITE("oracle") {
  TEST_CASE("no contact of a robot with itself is missed") {
    for (const std::string& path : robot_files()) {
      INFO(path);
      const auto loaded = load_approximated_robot(path);
      REQUIRE_MESSAGE(loaded.has_value(), (loaded ? "" : loaded.error().message));
      const Robot& robot = loaded->robot;
      const std::vector<Pair> pairs = pairs_to_check(path, robot);
      const CollisionChecker checker = require_checker(robot, Scene{});
      FclRobot oracle(robot);
      Rng rng(7);
      const std::vector<float> rows = random_states(robot, rounds(300), rng);
      const std::vector<std::uint8_t> is_valid = check_all(checker, rows);
      int touching = 0, free = 0;
      for (std::size_t i = 0; i < is_valid.size(); ++i) {
        const auto q = row(rows, i, robot);
        oracle.move_to(Configuration(q.begin(), q.end()));
        const auto found =
            std::ranges::find_if(pairs, [&](const Pair& pair) { return oracle.touch(pair); });
        touching += found != pairs.end() ? 1 : 0;
        free += is_valid[i];
        if (found == pairs.end()) continue;
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
