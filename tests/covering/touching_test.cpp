// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "covering/small_parts.h"
#include "covering/touching.h"

#include <cmath>

namespace mneme::test {
namespace {

using internal::PosedShapes;

Robot make_arm(std::vector<Sphere> spheres, std::vector<Capsule> capsules) {
  Robot::Parts parts = make_bare_chain(2);
  parts.links[0].spheres = {{{0, 0, 0}, 0.1}};
  parts.links[2].spheres = std::move(spheres);
  parts.links[2].capsules = std::move(capsules);
  const auto robot = make_robot(parts);
  REQUIRE_MESSAGE(robot.has_value(), (robot ? "" : robot.error().message));
  return *robot;
}

TEST_SUITE("unit") {
  TEST_CASE("links without shapes touch nothing") {
    const Robot robot = make_arm({}, {});
    PosedShapes shapes(robot);
    shapes.pose(Configuration{0, 0});
    CHECK_FALSE(shapes.touch(0, 2));
    CHECK_FALSE(shapes.touch(0, 1));
  }
}

TEST_SUITE("law") {
  TEST_CASE("links touch where their shapes are closer than the radii") {
    // The shapes of l2 are around the point p in its frame, or between two points.
    const Vec3 p(-1, 0.3, 0.1);
    const Vec3 end(0.2, 0.3, 0.1);
    const Robot balls = make_arm({{end, 0.1}, {p, 0.25}}, {});
    const Robot capsule = make_arm({}, {{p, end, 0.25}});
    PosedShapes ball_shapes(balls);
    PosedShapes capsule_shapes(capsule);
    Rng rng(9);
    int touching = 0;
    for (int i = 0; i < 500; ++i) {
      const Configuration q = random_configuration(balls, rng);
      const Transform pose = balls.link_poses(q)[2];
      ball_shapes.pose(q);
      capsule_shapes.pose(q);
      const bool near = (pose * p).norm() < 0.35;
      CHECK(ball_shapes.touch(0, 2) == (near || (pose * end).norm() < 0.2));
      CHECK(ball_shapes.touch(2, 0) == ball_shapes.touch(0, 2));
      CHECK(capsule_shapes.touch(0, 2) ==
            (segment_distance(pose * p, pose * end, Vec3::Zero(), Vec3::Zero()) < 0.35));
      touching += ball_shapes.touch(0, 2) ? 1 : 0;
    }
    CHECK(touching > 5);
    CHECK(touching < 300);
  }
}

}  // namespace
}  // namespace mneme::test
