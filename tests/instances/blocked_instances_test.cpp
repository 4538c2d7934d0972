// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/instances.h"

#include "instances/known_robot.h"

namespace mneme::test {
namespace {

BlockedInstances require_blocked(const Robot& robot, int count, std::uint64_t seed) {
  auto made = require(make_blocked_instances(robot, count, {}, seed));
  REQUIRE(std::ssize(made.instances) == count);
  return made;
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("both ends are free, and no configuration at an angle of the proof is") {
    for (const char* name : {"panda", "ur5", "fetch", "planar8"}) {
      CAPTURE(name);
      const Robot robot = known_robot(name);
      const auto turn = static_cast<std::size_t>(find_symmetric_joints(robot).turn);
      const auto sampler = make_uniform_sampler(robot);
      const auto states = sampler->start(7);
      std::vector<float> q(static_cast<std::size_t>(robot.joint_count()));
      for (const BlockedInstance& instance : require_blocked(robot, 4, 1).instances) {
        const CollisionChecker checker = make_checker(robot, instance.scene);
        CHECK(checker.is_valid(std::span<const double>(instance.start)));
        CHECK(checker.is_valid(std::span<const double>(instance.goal)));
        CHECK(robot.group_joint(static_cast<int>(turn)).name == instance.joint);
        const bool is_continuous =
            robot.group_joint(static_cast<int>(turn)).type == JointType::continuous;
        REQUIRE(instance.angles.size() == (is_continuous ? 2 : 1));
        const auto is_between = [&](const Configuration& end) {
          return end[turn] > instance.angles.front() && end[turn] < instance.angles.back();
        };
        if (is_continuous) {
          CHECK(is_between(instance.start) != is_between(instance.goal));
        } else {
          CHECK(instance.start[turn] < instance.angles[0]);
          CHECK(instance.goal[turn] > instance.angles[0]);
        }
        for (const double angle : instance.angles) {
          for (int i = 0; i < 300; ++i) {
            states->next(q);
            q[turn] = static_cast<float>(angle);
            CHECK_FALSE(checker.is_valid(q));
          }
        }
      }
    }
  }

  TEST_CASE("the same seed gives the same blocked instances, more of them continue the list") {
    const Robot robot = known_robot("panda");
    const auto two = require_blocked(robot, 2, 5), three = require_blocked(robot, 3, 5);
    for (std::size_t i = 0; i < 2; ++i) {
      CHECK(two.instances[i].start == three.instances[i].start);
      CHECK(two.instances[i].angles == three.instances[i].angles);
    }
    CHECK(three.instances[0].start != three.instances[1].start);
  }
}

TEST_SUITE("contract") {
  TEST_CASE("a robot that nothing turns cannot be blocked by a post") {
    CHECK(contains(require_error(make_blocked_instances(upright_arm(), 1, {}, 1)).message,
                   "turns all others"));
  }
}

}  // namespace mneme::test
