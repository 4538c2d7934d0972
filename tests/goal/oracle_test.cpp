// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// KDL (Orocos) looks at the solutions, and solves the same poses.
#include "goal/posed_robots.h"

#ifdef MNEME_HAS_KDL
#include "support/kdl_chain.h"

#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolverpos_lma.hpp>
#endif

namespace mneme::test {
namespace {

TEST_SUITE("oracle") {
#ifdef MNEME_HAS_KDL
  TEST_CASE("KDL finds the link where it was to be, and reaches no pose that mneme does not") {
    for (const auto& [name, link] :
         {std::pair("panda", "panda_hand"), std::pair("fetch", "gripper_link"),
          std::pair("ur5", "tool0")}) {
      const Robot robot = shipped_robot(name);
      CAPTURE(robot.name());
      const KdlChain kdl(robot, link);
      KDL::ChainFkSolverPos_recursive forward(kdl.chain);
      KDL::ChainIkSolverPos_LMA peer(kdl.chain, 1e-5, 200);
      const InverseKinematics kinematics = require(InverseKinematics::make(robot, link));
      Rng rng(9);
      int found = 0, found_by_kdl_alone = 0;
      for (int i = 0; i < 200; ++i) {
        const PoseGoal goal = pose_at(robot, link, random_configuration(robot, rng));
        const Configuration near = random_configuration(robot, rng);
        const IkResult result = kinematics.solve(goal, near);
        for (const Configuration& q : result.solutions) {
          KDL::Frame X;
          REQUIRE(forward.JntToCart(kdl.to_kdl_joints(q), X) >= 0);
          const KDL::Twist off = KDL::diff(X, to_kdl(goal.pose));
          CHECK(off.vel.Norm() < 1e-4);
          CHECK(off.rot.Norm() < 1e-3);
        }
        KDL::JntArray out(kdl.lower.rows());
        const bool is_solved = peer.CartToJnt(kdl.to_kdl_joints(near), to_kdl(goal.pose), out) >= 0;
        found += !result.solutions.empty();
        found_by_kdl_alone += is_solved && result.solutions.empty();
      }
      CHECK(found >= 199);
      CHECK(found_by_kdl_alone <= 1);
    }
  }
#else
  TEST_CASE("KDL finds the link where it was to be, and reaches no pose that mneme does not") {
    MESSAGE("skipped: this was built without KDL (liborocos-kdl-dev)");
  }
#endif
}

}  // namespace
}  // namespace mneme::test
