// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/as_index.h"
#include "check/cones.h"
#include "spheres/small_parts.h"
#include "goal/posed_robots.h"

#include <cmath>

namespace mneme::test {
namespace {

using internal::as_index;
using internal::Cone;
using internal::Cones;

std::vector<float> random_floats(const Robot& robot, Rng& rng) {
  const Configuration q = random_configuration(robot, rng);
  return {q.begin(), q.end()};
}

double tilt_of(const Robot& robot, const OrientationConstraint& constraint,
               const std::vector<float>& q) {
  return tilt(robot, constraint, Configuration(q.begin(), q.end()));
}

TEST_SUITE("law") {
  TEST_CASE("cosines are those of link poses, and gradients those of differences") {
    // Lifts, continuous joints and joints that follow others are on the way to the hand.
    const Robot robot = odd_arm();
    const OrientationConstraint constraint{kOddHand, Vec3(0, 0.6, 0.8), Vec3(0.8, 0, 0.6), 0.3};
    const Cone cone(robot, constraint);
    Rng rng(3);
    for (int i = 0; i < 100; ++i) {
      std::vector<float> q = random_floats(robot, rng);
      CHECK(cone.cosine(q.data()) ==
            doctest::Approx(std::cos(tilt_of(robot, constraint, q))).epsilon(1e-9));
      std::vector<double> gradient(q.size());
      CHECK(cone.cosine_and_gradient(q.data(), gradient) ==
            doctest::Approx(cone.cosine(q.data())).epsilon(1e-9));
      for (std::size_t j = 0; j < q.size(); ++j) {
        std::vector<float> delta(q.size());
        delta[j] = 1;
        const double slope = (cone.cosine(q.data(), delta.data(), 1e-5) -
                              cone.cosine(q.data(), delta.data(), -1e-5)) /
                             2e-5;
        CHECK(gradient[j] == doctest::Approx(slope).epsilon(1e-6));
      }
    }
  }

  TEST_CASE("projection leads into all cones, within the limits") {
    const Robot robot = shipped_robot("panda");
    const std::vector<OrientationConstraint> constraints = {
        {kHand, Vec3::UnitX(), Vec3::UnitZ(), 0.2}, {kHand, Vec3::UnitZ(), Vec3::UnitX(), 1}};
    const Cones cones(robot, constraints);
    Rng rng(3);
    int led = 0;
    for (int i = 0; i < 500; ++i) {
      std::vector<float> q = random_floats(robot, rng);
      const std::vector<float> before = q;
      if (!cones.project(q)) {
        CHECK(q == before);
        continue;
      }
      ++led;
      CHECK(!robot.describe_violation(Configuration(q.begin(), q.end()), "q"));
      for (const OrientationConstraint& constraint : constraints) {
        CHECK(tilt_of(robot, constraint, q) < constraint.angle);
      }
    }
    CHECK(led > 100);
  }

  TEST_CASE("a motion that is said to stay in a cone does so, and few others are refused") {
    const Robot robot = shipped_robot("panda");
    const OrientationConstraint constraint{kHand, Vec3::UnitX(), Vec3::UnitZ(), 0.2};
    const Cones cones(robot, {&constraint, 1});
    Rng rng(3);
    int kept = 0, refused = 0;
    for (int i = 0; i < 3000; ++i) {
      std::vector<float> from = random_floats(robot, rng);
      if (!cones.project(from)) continue;
      std::vector<float> to = from;
      for (float& value : to) value += 0.1f * rng.bell();
      const Path path = {{from.begin(), from.end()}, {to.begin(), to.end()}};
      const double largest = largest_tilt(robot, constraint, path, 1e-3);
      if (cones.contain_motion(from, to, {})) {
        ++kept;
        CHECK(largest <= constraint.angle);
      } else {
        refused += largest < constraint.angle - 1e-3;
      }
    }
    CHECK(kept > 100);
    CHECK(refused == 0);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("a motion may leave the edge of a cone, and none goes over it between its ends") {
    // A plane turn: the tilt is the joint's value.
    const Robot robot = odd_arm();
    const OrientationConstraint constraint{"link_9", Vec3::UnitZ(), Vec3::UnitZ(), 0.5};
    const Cones cones(robot, {&constraint, 1});
    std::vector<float> from(as_index(robot.joint_count())), to = from, bow = from;
    int j = 0;
    while (robot.group_joint(j).child_link != *robot.find_link(constraint.link)) ++j;
    from[as_index(j)] = 0.49998f;
    CHECK(cones.contain_motion(from, to, {}));
    CHECK(cones.contain_motion(to, from, {}));
    to[as_index(j)] = -0.49998f;
    CHECK(cones.contain_motion(from, to, {}));
    bow[as_index(j)] = 0.001f;
    CHECK_FALSE(cones.contain_motion(from, to, bow));
    to[as_index(j)] = 0.501f;
    CHECK_FALSE(cones.contain_motion(from, to, {}));
  }

  TEST_CASE("steps of a path are counted at any resolution, and there is none of no length") {
    const Robot robot = odd_arm();
    const OrientationConstraint constraint{"link_9", Vec3::UnitZ(), Vec3::UnitZ(), 0.5};
    const Configuration q(as_index(robot.joint_count()));
    for (const double resolution : {0.0, -1.0, std::nan("")}) {
      CHECK(std::isinf(largest_tilt(robot, constraint, {q, q}, resolution)));
    }
  }

  TEST_CASE("states that are no numbers have no largest tilt") {
    const Robot robot = odd_arm();
    const OrientationConstraint constraint{"link_9", Vec3::UnitZ(), Vec3::UnitZ(), 0.5};
    const Configuration q(as_index(robot.joint_count())), none(q.size(), std::nan(""));
    for (const Path& path : {Path{none}, Path{none, q}, Path{q, none}, Path{q, none, q}}) {
      CHECK(std::isinf(largest_tilt(robot, constraint, path, 0.1)));
      CHECK_FALSE(keeps_cone(robot, constraint, path, 0.1, {}));
    }
  }

  TEST_CASE("a joint that follows another at rate 0 is not driven") {
    Robot::Parts parts = make_bare_chain(2);
    parts.joints[0].type = JointType::prismatic;
    parts.joints[1].mimic = Mimic{0, 0, 0.5};
    const Robot robot = make_robot(parts).value();
    const OrientationConstraint upright{"l2", Vec3::UnitX(), Vec3::UnitX(), 0.1};
    CHECK(describe_fault(robot, upright) == "no joint of the planning group turns link \"l2\"");
    const float q = 0.3f;
    CHECK(Cone(robot, upright).cosine(&q) ==
          doctest::Approx(std::cos(tilt(robot, upright, Configuration{q}))));
  }

  TEST_CASE("constraints that no robot can keep are described") {
    const Robot robot = shipped_robot("panda");
    const auto fault = [&](const OrientationConstraint& constraint) {
      return describe_fault(robot, constraint).value_or("");
    };
    const Vec3 z = Vec3::UnitZ();
    CHECK(fault({kHand, z, z, 0.1}).empty());
    CHECK(fault({"nose", z, z, 0.1}) == "expected a link of robot panda, got \"nose\"");
    CHECK(fault({"panda_link0", z, z, 0.1}) ==
          "no joint of the planning group turns link \"panda_link0\"");
    CHECK(fault({kHand, 2 * z, z, 0.1}) == "expected directions of unit length, got one of 2");
    CHECK(fault({kHand, z, z, 0}) == "expected an angle of 0.001 rad or more, got 0");
    CHECK(fault({kHand, z, z, std::nan("")}) == "expected an angle of 0.001 rad or more, got nan");
  }
}

}  // namespace
}  // namespace mneme::test
