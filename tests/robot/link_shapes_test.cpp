// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/link_shapes.h"
#include "support/support.h"

#include <numbers>

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("a link's spheres are capsules of length 0, and move with it") {
    const Link link{"tool", -1, {{{1, 0, 0}, 0.5}}, {{{0, 0, 0}, {0, 2, 0}, 0.25}}, {}};
    const Transform turned{rotation_about(Vec3::UnitZ(), std::numbers::pi / 2), Vec3(0, 0, 3)};
    const std::vector<Capsule> shapes = internal::shapes_of(link, turned);
    REQUIRE(shapes.size() == 2);
    CHECK(shapes[0].a == shapes[0].b);
    CHECK((shapes[0].a - Vec3(0, 1, 3)).norm() < 1e-12);
    CHECK(shapes[0].radius == 0.5);
    CHECK((shapes[1].a - Vec3(0, 0, 3)).norm() < 1e-12);
    CHECK((shapes[1].b - Vec3(-2, 0, 3)).norm() < 1e-12);
    CHECK(internal::shapes_of(link)[1].b == Vec3(0, 2, 0));
  }

  TEST_CASE("has_shapes tells empty links from others") {
    CHECK_FALSE(internal::has_shapes({"frame", -1, {}, {}, {}}));
    CHECK(internal::has_shapes({"ball", -1, {{{0, 0, 0}, 1}}, {}, {}}));
    CHECK(internal::has_shapes({"rod", -1, {}, {{{0, 0, 0}, {1, 0, 0}, 1}}, {}}));
  }

  TEST_CASE("the bound of no shapes is a point, that of one sphere the sphere") {
    CHECK(internal::bound_of({}).radius == 0);
    const Capsule ball{{1, 2, 3}, {1, 2, 3}, 0.5};
    const Sphere bound = internal::bound_of(std::span(&ball, 1));
    CHECK(bound.center == ball.a);
    CHECK(bound.radius == 0.5);
  }

  TEST_CASE("links move with the group's joints, with those that follow them, and with parents") {
    Robot::Parts parts;
    parts.name = "hand";
    for (const char* name : {"base", "arm", "finger", "thumb", "lamp", "stop"}) {
      parts.links.push_back({name, -1, {{{0, 0, 0}, 0.01}}, {}, {}});
    }
    const auto add = [&](const char* name, JointType type, int parent, int child) {
      Joint joint;
      joint.name = name;
      joint.type = type;
      joint.parent_link = parent;
      joint.child_link = child;
      joint.lower = -1;
      joint.upper = 1;
      joint.axis = Vec3::UnitZ();
      parts.joints.push_back(joint);
    };
    add("turn", JointType::revolute, 0, 1);
    add("grip", JointType::revolute, 1, 2);
    add("weld", JointType::fixed, 2, 3);
    add("lift", JointType::prismatic, 0, 4);
    parts.joints[3].mimic = Mimic{1, 0.5, 0};
    add("hinge", JointType::revolute, 0, 5);
    parts.joints[4].mimic = Mimic{1, 0, 0.5};
    RobotOptions options;
    options.joints = {"grip"};
    const auto robot = make_robot(parts, options);
    REQUIRE(robot.has_value());
    const std::vector<bool> is_moving = internal::find_moving_links(*robot);
    for (std::size_t i = 0; i < robot->links().size(); ++i) {
      const std::string& name = robot->links()[i].name;
      CHECK_MESSAGE(is_moving[i] == (name == "finger" || name == "thumb" || name == "lamp"), name);
    }
  }
}

TEST_SUITE("law") {
  TEST_CASE("the bound holds every shape") {
    Rng rng(5);
    for (int round = 0; round < 100; ++round) {
      std::vector<Capsule> shapes;
      const auto point = [&] {
        return Vec3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
      };
      for (std::size_t i = 0; i <= rng.index(5); ++i) {
        shapes.push_back({point(), point(), rng.uniform(0.01, 0.5)});
      }
      const Sphere bound = internal::bound_of(shapes);
      for (const Capsule& shape : shapes) {
        CHECK((shape.a - bound.center).norm() + shape.radius <= bound.radius + 1e-12);
        CHECK((shape.b - bound.center).norm() + shape.radius <= bound.radius + 1e-12);
      }
    }
  }
}

}  // namespace mneme::test
