// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bent_path/bent_path.h"
#include "cell/branch.h"
#include "cell/cells.h"
#include "support/lifting_arm.h"

#include <doctest/doctest.h>

namespace mneme::test {
namespace {

using internal::JointVector;

/// A lift, a continuous turn, three joints about other axes, one of which another follows, and a
/// twist.
Robot odd_chain() {
  Robot::Parts parts;
  parts.name = "odd";
  parts.links.push_back({.name = "base"});
  const auto hang = [&](JointType type, const Vec3& at, const Vec3& axis, double most) {
    const int parent = static_cast<int>(parts.links.size()) - 1;
    hang_link(parts, parent, joint_at(type, at, axis.normalized(), -most, most), {}, {});
  };
  hang(JointType::prismatic, Vec3(0, 0, 0.5), Vec3::UnitZ(), 0.4);
  hang(JointType::continuous, Vec3(0, 0, 0.1), Vec3::UnitZ(), kPi);
  hang(JointType::revolute, Vec3(0.1, 0, 0), Vec3(0, 0.6, 0.8), 2);
  hang(JointType::revolute, Vec3(0.5, 0, 0), -Vec3::UnitY(), 2.4);
  hang(JointType::revolute, Vec3(0.2, 0, 0), Vec3::UnitX(), 3);
  hang(JointType::revolute, Vec3(0.2, 0.1, 0), Vec3(1, 1, 0), 3);
  hang(JointType::revolute, Vec3(0.1, 0, 0), Vec3::UnitZ(), 3);
  parts.joints[4].mimic = Mimic{3, -0.5, 0.2};
  return robot_of(parts);
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a chain places its link as the robot does, and its Jacobian is the slope") {
    const Robot robot = odd_chain();
    const auto chain = require(internal::LinkChain::make(robot, "link_7"));
    Rng rng(1);
    for (int i = 0; i < 10; ++i) {
      const Configuration q = random_configuration(robot, rng);
      internal::Jacobian jacobian;
      const Transform pose = chain.place(internal::to_vector(q), &jacobian);
      const Transform expected = robot.link_poses(q).back();
      CHECK(pose.translation.isApprox(expected.translation, 1e-12));
      CHECK(pose.rotation.isApprox(expected.rotation, 1e-12));
      for (std::size_t j = 0; j < q.size(); ++j) {
        Configuration moved = q;
        constexpr double kStep = 1e-6;
        moved[j] += kStep;
        const Vec3 slope = (robot.link_poses(moved).back().translation - pose.translation) / kStep;
        CHECK((slope - jacobian.col(static_cast<Eigen::Index>(j)).head<3>()).norm() < 1e-5);
      }
    }
  }

  TEST_CASE("an arm of too few joints is refused") {
    const Error error = require_error(internal::LinkChain::make(lifting_arm(), "link_4"));
    CHECK(error.code == ErrorCode::unsupported);
  }

  TEST_CASE("a fitted branch is within its rest of inverse kinematics, and reaches the pose") {
    const TemporaryDirectory directory;
    const CellRegion region = require_region(directory, region_text("{x: 0.1, y: 0.1, yaw: 0.3}"));
    const internal::TaskFrame frame(region);
    const auto chain = require(internal::LinkChain::make(region.problem.robot, "panda_hand"));
    const internal::BranchFitter fitter(chain, frame);
    JointVector q = internal::to_vector(region.problem.start);
    REQUIRE(chain.reach(frame.pose({}), chain.response(q), 30, 1e-7, q));
    const internal::TaskBox box{{0.02, -0.03, 0, 0.1}, {0.03, 0.04, 0, 0.1}};
    REQUIRE(internal::follow(chain, frame, {}, box.center, 4, q));
    const internal::Branch branch = internal::make_branch(chain, q);
    GoalShift shift;
    REQUIRE(fitter.fit(box, branch, shift) == internal::FitFault::none);
    Rng rng(2);
    for (int i = 0; i < 500; ++i) {
      std::array<double, kMostParameters> u;
      for (double& value : u) {
        const double share = rng.uniform(-1, 1);
        value = i % 2 == 0 ? share : std::copysign(1.0, share);
      }
      const JointVector modelled = branch.q0 + internal::evaluate(shift, u.data());
      JointVector exact = modelled;
      const Transform pose = frame.pose(box.at(frame.varying(), u.data()));
      REQUIRE(chain.reach(pose, branch.response, 8, 1e-8, exact));
      JointVector same = modelled;
      REQUIRE(chain.reach(pose, chain.directions(branch.q0), 8, 1e-8, same));
      CHECK((same - exact).norm() < 1e-6);
      for (Eigen::Index j = 0; j < exact.size(); ++j) {
        CHECK(std::abs(exact[j] - modelled[j]) <= double{shift.rest[static_cast<std::size_t>(j)]});
      }
      CHECK((chain.place(exact).translation - pose.translation).norm() < 1e-7);
    }
  }
}

}  // namespace mneme::test
