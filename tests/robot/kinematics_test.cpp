// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/joint_space.h"
#include "robot/kinematics.h"
#include "robot/small_robots.h"
#include "support/support.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace mneme {

using test::kPi;

TEST_SUITE("unit") {
  TEST_CASE("a prismatic joint shifts its link along the axis of its turned frame") {
    Robot::Parts parts = test::make_chain(1, JointType::prismatic);
    parts.joints[0].origin.rotation = rotation_from_rpy(Vec3(0, 0, kPi / 2));
    parts.joints[0].axis = Vec3(2, 0, 0);
    const Robot robot = test::require_robot(parts);
    const std::vector<double> q{0.25};
    CHECK((robot.link_poses(q)[1].translation - Vec3(1, 0.25, 0)).norm() < 1e-15);
  }

  TEST_CASE("a joint about a slanted axis turns its link about that axis") {
    Robot::Parts parts = test::make_chain(1);
    parts.joints[0].axis = Vec3(1, 1, 1);
    const Robot robot = test::require_robot(parts);
    // A third of a turn about the space diagonal takes x to y.
    const std::vector<double> q{2 * kPi / 3};
    CHECK((robot.link_poses(q)[1] * Vec3(1, 0, 0) - Vec3(1, 1, 0)).norm() < 1e-15);
  }

  TEST_CASE("a joint outside the group stands at its fixed value") {
    const Robot robot = test::require_robot(test::make_chain(2),
                                            {.joints = {"j2"}, .fixed_values = {{"j1", kPi / 2}}});
    const std::vector<double> q{0.0};
    CHECK((robot.link_poses(q)[2].translation - Vec3(1, 1, 0)).norm() < 1e-15);
  }

  TEST_CASE("values go to joints in the order of the group") {
    const Robot robot = test::require_robot(test::make_chain(2), {.joints = {"j2", "j1"}});
    const std::vector<double> q{0.0, kPi / 2};
    CHECK((robot.link_poses(q)[2].translation - Vec3(1, 1, 0)).norm() < 1e-15);
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("the planar arm's link origins are sums of lengths along summed angles") {
    const Robot robot = test::planar8();
    const std::vector<double> lengths{1.6, 1.4, 1.8, 1.2, 1.5, 1.3, 1.1, 1.7};
    Rng rng(11);
    for (int repetition = 0; repetition < 200; ++repetition) {
      const Configuration q = test::random_configuration(robot, rng);
      const std::vector<Transform> poses = robot.link_poses(q);
      CHECK(poses[0].translation.norm() == 0);
      double x = 0, y = 0, angle = 0;
      for (std::size_t i = 0; i < lengths.size(); ++i) {
        CHECK((poses[i + 1].translation - Vec3(x, y, 0)).norm() < 1e-13);
        angle += q[i];
        x += lengths[i] * std::cos(angle);
        y += lengths[i] * std::sin(angle);
        const Capsule& capsule = robot.links()[i + 1].capsules.at(0);
        const Vec3 tip = poses[i + 1] * capsule.b;
        CHECK((tip - Vec3(x, y, 0)).norm() < 1e-13);
      }
    }
  }
}

TEST_SUITE("law") {
  TEST_CASE("poses are rigid and joint 1 turns the whole arm") {
    const Robot robot = test::planar8();
    Rng rng(12);
    for (int repetition = 0; repetition < 100; ++repetition) {
      Configuration q = test::random_configuration(robot, rng);
      const std::vector<Transform> before = robot.link_poses(q);
      const double turn = rng.uniform(-kPi, kPi);
      q[0] += turn;
      const std::vector<Transform> after = robot.link_poses(q);
      const Eigen::Matrix3d rotation = rotation_about(Vec3::UnitZ(), turn);
      for (std::size_t i = 1; i < before.size(); ++i) {
        const Eigen::Matrix3d& r = before[i].rotation;
        CHECK((r * r.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-14);
        CHECK((after[i].translation - rotation * before[i].translation).norm() < 1e-13);
      }
    }
  }
}

namespace {

using test::contains;

double norm(const Configuration& v) {
  double sum = 0;
  for (const double x : v) sum += x * x;
  return std::sqrt(sum);
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a configuration of wrong length is refused with both counts") {
    const Robot robot = test::require_robot(test::make_chain(3));
    const std::vector<double> q{0, 0};
    const std::string why = robot.describe_violation(q, "start").value();
    CHECK(contains(why, "start: there are 2 values"));
    CHECK(contains(why, "3 joints"));
    const std::vector<double> one{0}, two{0, 0};
    CHECK(contains(robot.describe_violation(one, "start").value(), "there is 1 value, but"));
    CHECK(contains(test::require_robot(test::make_chain(1)).describe_violation(two, "q").value(),
                   "has 1 joint in its group"));
  }

  TEST_CASE("a value that is no number is refused by joint") {
    const Robot robot = test::require_robot(test::make_chain(2));
    const std::vector<double> q{0, std::nan("")};
    CHECK(contains(robot.describe_violation(q, "goal").value(), "goal: joint 'j2'"));
    const std::vector<double> infinite{std::numeric_limits<double>::infinity(), 0};
    CHECK(contains(robot.describe_violation(infinite, "goal").value(), "goal: joint 'j1'"));
  }

  TEST_CASE("a value beyond its limit by more than 1e-5 is refused with the limits") {
    const Robot robot = test::require_robot(test::make_chain(2));
    CHECK_FALSE(robot.describe_violation(std::vector<double>{2 + 0.9e-5, -2 - 0.9e-5}, "start"));
    const std::vector<double> q{0, -2 - 1.1e-5};
    CHECK(contains(robot.describe_violation(q, "start").value(), "outside its limits [-2, 2]"));
    const Robot endless = test::require_robot(test::make_chain(1, JointType::continuous));
    CHECK_FALSE(endless.describe_violation(std::vector{-1e4}, "start").has_value());
    CHECK(endless.describe_violation(std::vector{1e308}, "start") ==
          "start: joint 'j1' (value 1 of 1) is 1e+308, expected at most 10000 rad");
  }

  TEST_CASE("a continuous joint may have any angle") {
    const Robot robot = test::require_robot(test::make_chain(1, JointType::continuous));
    CHECK_FALSE(robot.describe_violation(std::vector<double>{100.0}, "start"));
  }

  TEST_CASE("normalizing wraps continuous joints to [-pi, pi) and clamps others") {
    const Robot arm = test::planar8();
    Configuration q(8, 3.5);
    q[0] = kPi;
    q[7] = -4;
    const Configuration normal = arm.normalized(q);
    CHECK(normal[0] == -kPi);
    CHECK(normal[1] == kPi);
    CHECK(normal[7] == -kPi);
    q[0] = 7;
    CHECK(arm.normalized(q)[0] == doctest::Approx(7 - 2 * kPi).epsilon(1e-14));
  }

  TEST_CASE("only the continuous joint takes the shorter way round") {
    const Robot arm = test::planar8();
    Configuration a(8, 0.0), b(8, 0.0);
    a[0] = a[1] = 3;
    b[0] = b[1] = -3;
    const Configuration step = arm.difference(a, b);
    CHECK(step[0] == doctest::Approx(2 * kPi - 6));
    CHECK(step[1] == -6);
    CHECK(arm.distance(a, b) == doctest::Approx(std::hypot(2 * kPi - 6, 6)));
  }
}

TEST_SUITE("law") {
  TEST_CASE("differences are antisymmetric and lead from one configuration to the other") {
    const Robot arm = test::planar8();
    Rng rng(21);
    for (int repetition = 0; repetition < 500; ++repetition) {
      const Configuration a = test::random_configuration(arm, rng);
      const Configuration b = test::random_configuration(arm, rng);
      const Configuration there = arm.difference(a, b), back = arm.difference(b, a);
      Configuration end = a;
      for (std::size_t i = 0; i < a.size(); ++i) {
        CHECK(there[i] == -back[i]);
        end[i] += there[i];
      }
      CHECK(std::abs(there[0]) <= kPi);
      CHECK(arm.distance(end, b) < 1e-14);
    }
  }

  TEST_CASE("distance is a metric and the norm of the difference") {
    const Robot arm = test::planar8();
    Rng rng(22);
    for (int repetition = 0; repetition < 500; ++repetition) {
      const Configuration a = test::random_configuration(arm, rng);
      const Configuration b = test::random_configuration(arm, rng);
      const Configuration c = test::random_configuration(arm, rng);
      CHECK(arm.distance(a, a) == 0);
      CHECK(arm.distance(a, b) > 0);
      CHECK(arm.distance(a, b) == arm.distance(b, a));
      CHECK(arm.distance(a, c) <= arm.distance(a, b) + arm.distance(b, c) + 1e-12);
      CHECK(arm.distance(a, b) == doctest::Approx(norm(arm.difference(a, b))).epsilon(1e-14));
    }
  }

  TEST_CASE("normalizing changes nothing twice, nor the pose of any link") {
    const Robot arm = test::planar8();
    Rng rng(23);
    for (int repetition = 0; repetition < 100; ++repetition) {
      Configuration q = test::random_configuration(arm, rng);
      q[0] = rng.uniform(-50, 50);
      const Configuration normal = arm.normalized(q);
      CHECK(arm.normalized(normal) == normal);
      CHECK((normal[0] >= -kPi && normal[0] < kPi));
      CHECK_FALSE(arm.describe_violation(normal, "q"));
      const Vec3 tip = arm.link_poses(q).back().translation;
      CHECK((arm.link_poses(normal).back().translation - tip).norm() < 1e-12);
    }
  }
}

}  // namespace mneme

namespace mneme::test {
namespace {

/// A continuous, a revolute and a prismatic joint.
Robot mixed_robot() {
  Robot::Parts parts = make_chain(3);
  parts.joints[0].type = JointType::continuous;
  parts.joints[2].type = JointType::prismatic;
  parts.joints[2].lower = 0.25;
  parts.joints[2].upper = 1.5;
  return require_robot(parts);
}

float to_limits(const internal::JointSpace& space, int joint, double value) {
  return space.into_limits(joint, static_cast<float>(value));
}

TEST_SUITE("unit") {
  TEST_CASE("limits in single precision lie within those in double precision, and next to them") {
    for (const double limit : {0.38615, 0.1, kPi, 1.6056, 2e-5, 0.5}) {
      Robot::Parts parts = make_chain(1);
      parts.joints[0].lower = -limit;
      parts.joints[0].upper = limit;
      const internal::JointSpace space(require_robot(parts));
      CHECK(static_cast<double>(space.upper(0)) <= limit);
      CHECK(static_cast<double>(space.lower(0)) >= -limit);
      CHECK(space.upper(0) == doctest::Approx(limit).epsilon(1e-6));
      CHECK(space.into_limits(0, 9) == space.upper(0));
      CHECK(space.into_limits(0, -9) == space.lower(0));
    }
  }

  TEST_CASE("a joint that its limits lock has one value, which is next to them") {
    for (const double value : {0.1, -0.1, 0.5, 1.6056}) {
      Robot::Parts parts = make_chain(1);
      parts.joints[0].lower = parts.joints[0].upper = value;
      const internal::JointSpace space(require_robot(parts));
      CHECK(space.lower(0) == space.upper(0));
      CHECK(space.upper(0) == doctest::Approx(value).epsilon(1e-6));
      for (const float other : {-9.0f, space.upper(0), 9.0f}) {
        CHECK(space.into_limits(0, other) == space.upper(0));
      }
    }
  }

  TEST_CASE("limits and periods are those of the group, in its order") {
    const internal::JointSpace space(mixed_robot());
    REQUIRE(space.joint_count() == 3);
    CHECK(space.lower(0) == doctest::Approx(-kPi));
    CHECK(space.upper(0) == doctest::Approx(kPi));
    CHECK(space.lower(1) == -2.0f);
    CHECK(space.upper(1) == 2.0f);
    CHECK(space.lower(2) == 0.25f);
    CHECK(space.upper(2) == 1.5f);
    REQUIRE(space.periods().size() == 3);
    CHECK(space.periods()[0] == static_cast<float>(2 * kPi));
    CHECK(space.periods()[1] == 0.0f);
    CHECK(space.periods()[2] == 0.0f);

    Robot::Parts parts = make_chain(2);
    parts.joints[1].lower = -1;
    const internal::JointSpace reversed(require_robot(parts, test::plan_for({"j2", "j1"})));
    CHECK(reversed.lower(0) == -1.0f);
    CHECK(reversed.lower(1) == -2.0f);
  }

  TEST_CASE("a continuous joint wraps and the others stop at their limits") {
    const internal::JointSpace space(mixed_robot());
    CHECK(to_limits(space, 0, 1.25) == 1.25f);
    CHECK(to_limits(space, 0, 4) == doctest::Approx(4 - 2 * kPi));
    CHECK(to_limits(space, 0, -4) == doctest::Approx(2 * kPi - 4));
    CHECK(to_limits(space, 0, 100) == doctest::Approx(std::remainder(100, 2 * kPi)));
    CHECK(to_limits(space, 1, 1.25) == 1.25f);
    CHECK(to_limits(space, 1, 4) == 2.0f);
    CHECK(to_limits(space, 1, -4) == -2.0f);
    CHECK(to_limits(space, 2, 0) == 0.25f);
    CHECK(to_limits(space, 2, INFINITY) == 1.5f);
  }

  TEST_CASE("a displacement takes the shorter way round for continuous joints only") {
    const internal::JointSpace space(mixed_robot());
    const std::array a = {3.0f, 2.0f, 0.5f}, b = {-3.0f, -2.0f, 1.0f};
    std::array<float, 3> delta{};
    const float length = space.difference(a.data(), b.data(), delta.data());
    CHECK(delta[0] == doctest::Approx(2 * kPi - 6));
    CHECK(delta[1] == -4.0f);
    CHECK(delta[2] == 0.5f);
    CHECK(length == doctest::Approx(std::hypot(2 * kPi - 6, 4, 0.5)));
    CHECK(space.difference(a.data(), a.data(), delta.data()) == 0.0f);
  }

  TEST_CASE("a displacement of several turns is that of its remainder") {
    const internal::JointSpace space(mixed_robot());
    const std::array a = {0.0f, 0.0f, 1.0f}, b = {static_cast<float>(6 * kPi + 0.5), 0.0f, 1.0f};
    std::array<float, 3> delta{};
    CHECK(space.difference(a.data(), b.data(), delta.data()) == doctest::Approx(0.5).epsilon(1e-5));
  }
}

TEST_SUITE("law") {
  TEST_CASE("single precision agrees with the robot's own limits and differences") {
    const Robot robot = mixed_robot();
    const internal::JointSpace space(robot);
    Rng rng(601);
    for (int i = 0; i < 20000; ++i) {
      std::array<float, 3> a{}, b{}, delta{};
      for (std::size_t j = 0; j < 3; ++j) {
        a[j] = static_cast<float>(rng.uniform(-9.0, 9.0));
        b[j] = static_cast<float>(rng.uniform(-9.0, 9.0));
      }
      const Configuration exact_a(a.begin(), a.end()), exact_b(b.begin(), b.end());
      const float length = space.difference(a.data(), b.data(), delta.data());
      INFO("seed 601, case " << i);
      REQUIRE(std::abs(length - robot.distance(exact_a, exact_b)) < 1e-5);
      const Configuration limited = robot.normalized(exact_a);
      for (int j = 0; j < 3; ++j) {
        const auto k = static_cast<std::size_t>(j);
        const double error = space.into_limits(j, a[k]) - limited[k];
        // Half a turn may come out on either side.
        REQUIRE(std::abs(j == 0 ? std::remainder(error, 2 * kPi) : error) < 2e-6);
        // The joint arrives at `b`, give or take whole turns.
        const double missed = exact_a[k] + delta[k] - exact_b[k];
        REQUIRE(std::abs(j == 0 ? std::remainder(missed, 2 * kPi) : missed) < 5e-6);
      }
    }
  }

  TEST_CASE("whatever comes in, what comes out is a configuration of the robot") {
    const Robot robot = mixed_robot();
    const internal::JointSpace space(robot);
    Rng rng(602);
    for (int i = 0; i < 20000; ++i) {
      Configuration q;
      for (int j = 0; j < 3; ++j) {
        // Half turns and their neighbours are where wrapping may go wrong.
        float value = i % 4 == 0 ? static_cast<float>((static_cast<int>(rng.index(9)) - 4) * kPi)
                                 : static_cast<float>(rng.uniform(-20.0, 20.0));
        if (i % 8 == 0) value = std::nextafter(value, i % 16 == 0 ? 100.0f : -100.0f);
        q.push_back(space.into_limits(j, value));
        // A second time changes nothing except half a turn that rounding put on the other side.
        const double change = space.into_limits(j, static_cast<float>(q.back())) - q.back();
        REQUIRE(std::abs(j == 0 ? std::remainder(change, 2 * kPi) : change) < 1e-6);
      }
      REQUIRE(!robot.describe_violation(q, "sample"));
      REQUIRE(std::abs(q[0]) < kPi + 3e-6);
    }
  }

  TEST_CASE("there and back are as long, and opposite") {
    const internal::JointSpace space(mixed_robot());
    Rng rng(603);
    for (int i = 0; i < 5000; ++i) {
      std::array<float, 3> a{}, b{}, there{}, back{};
      for (std::size_t j = 0; j < 3; ++j) {
        a[j] = static_cast<float>(rng.uniform(-3.0, 3.0));
        b[j] = static_cast<float>(rng.uniform(-3.0, 3.0));
      }
      REQUIRE(space.difference(a.data(), b.data(), there.data()) ==
              space.difference(b.data(), a.data(), back.data()));
      REQUIRE(std::abs(there[0]) < kPi + 1e-6);
      for (std::size_t j = 0; j < 3; ++j) REQUIRE(there[j] == -back[j]);
    }
  }
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a link's spheres are capsules of length 0, and move with it") {
    const Link link{
        .name = "tool", .spheres = {{{1, 0, 0}, 0.5}}, .capsules = {{{0, 0, 0}, {0, 2, 0}, 0.25}}};
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
    CHECK_FALSE(internal::has_shapes({.name = "frame"}));
    CHECK(internal::has_shapes({.name = "ball", .spheres = {{{0, 0, 0}, 1}}}));
    CHECK(internal::has_shapes({.name = "rod", .capsules = {{{0, 0, 0}, {1, 0, 0}, 1}}}));
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
      parts.links.push_back({.name = name, .spheres = {{{0, 0, 0}, 0.01}}});
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
    const auto robot = require(make_robot(parts, {.joints = {"grip"}}));
    const std::vector<bool> is_moving = internal::find_moving_links(robot);
    for (std::size_t i = 0; i < robot.links().size(); ++i) {
      const std::string& name = robot.links()[i].name;
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
        return Vec3{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
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
