// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/collision.h"

#include "check/clearance.h"
#include "report/report_support.h"

#include <cmath>

namespace mneme::internal {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("Clearance is that of the nearest link and obstacle, and negative in contact") {
    const Robot robot = test::unit_arm(3);
    const Scene scene = make_circle_scene("two", {{2.5, 1, 0.4}, {-1, 0, 0.3}});
    const ClearanceMeter meter(robot, scene);
    const Clearance straight = meter.measure(robot.link_poses(Configuration{0, 0, 0}));
    CHECK(straight.distance == doctest::Approx(0.6 - 0.001));
    CHECK(robot.links()[static_cast<std::size_t>(straight.link)].name == "link_3");
    CHECK(straight.obstacle == 0);
    const Clearance back = meter.measure(robot.link_poses(Configuration{M_PI, 0, 0}));
    CHECK(back.distance == doctest::Approx(-0.001));
    CHECK(back.obstacle == 1);
  }

  TEST_CASE("Links that the group does not move have no say") {
    Robot::Parts parts;
    parts.name = "post";
    parts.links.resize(2);
    parts.links[0] = {.name = "base", .spheres = {{Vec3::Zero(), 0.1}}};
    parts.links[1] = {.name = "arm", .spheres = {{Vec3(1, 0, 0), 0.1}}};
    Joint& joint = parts.joints.emplace_back();
    joint.name = "turn";
    joint.type = JointType::continuous;
    joint.parent_link = 0;
    joint.child_link = 1;
    joint.axis = Vec3::UnitZ();
    joint.lower = -3.14159;
    joint.upper = 3.14159;
    const auto robot = make_robot(std::move(parts));
    REQUIRE(robot.has_value());
    const Scene scene = make_circle_scene("near the post", {{-0.3, 0, 0.1}});
    const Clearance clearance =
        ClearanceMeter(*robot, scene).measure(robot->link_poses(Configuration{0}));
    CHECK(clearance.distance == doctest::Approx(1.3 - 0.2));
    CHECK(robot->links()[static_cast<std::size_t>(clearance.link)].name == "arm");
  }

  TEST_CASE("Without obstacles clearance is infinite and has no names") {
    const Robot robot = test::unit_arm(2);
    const Scene empty;
    const Clearance clearance =
        ClearanceMeter(robot, empty).measure(robot.link_poses(Configuration{0, 0}));
    CHECK(std::isinf(clearance.distance));
    CHECK(clearance.link == -1);
    CHECK(clearance.obstacle == -1);
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("Clearance and the list of contacts agree about random arms among random shapes") {
    const Robot robot = test::unit_arm(4);
    Rng rng(11);
    int touching = 0;
    for (int k = 0; k < 300; ++k) {
      Scene scene = make_circle_scene("random", {{rng.uniform(-3, 3), rng.uniform(-3, 3), 0.5}});
      Box box;
      box.pose.translation = Vec3(rng.uniform(-3, 3), rng.uniform(-3, 3), 0);
      box.half_extents = Vec3(0.3, 0.2, 0.1);
      scene.obstacles.push_back({"box", {box}});
      const auto checker = CollisionChecker::make(robot, scene);
      REQUIRE(checker.has_value());
      const Configuration q = test::random_configuration(robot, rng);
      const Clearance clearance = ClearanceMeter(robot, scene).measure(robot.link_poses(q));
      if (std::abs(clearance.distance) < 1e-6) continue;
      bool is_touching = false;
      for (const Contact& contact : checker->contacts(q)) is_touching |= !contact.is_self;
      INFO("seed 11, case ", k);
      CHECK(is_touching == (clearance.distance < 0));
      touching += is_touching ? 1 : 0;
    }
    CHECK(touching > 30);
    CHECK(touching < 270);
  }
}

}  // namespace
}  // namespace mneme::internal
