// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/collision.h"

#include "check/link_distances.h"
#include "collision/random_worlds.h"
#include "spheres/small_parts.h"
#include "report/report_support.h"
#include "support/support.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace mneme::test {
namespace {

/// A post that stands still, and two links of 1 m, 5 cm in radius, that turn about z; the third
/// carries a ball.
constexpr const char* kArm = R"(<robot name="arm">
  <link name="post"><collision><origin xyz="0 0 -1"/>
    <geometry><capsule radius="0.1" length="1"/></geometry></collision></link>
  <link name="near"><collision><origin xyz="0.5 0 0" rpy="0 1.5707963267948966 0"/>
    <geometry><capsule radius="0.05" length="1"/></geometry></collision></link>
  <link name="far"><collision><origin xyz="0.5 0 0" rpy="0 1.5707963267948966 0"/>
    <geometry><capsule radius="0.05" length="1"/></geometry></collision></link>
  <link name="ball"><collision><origin xyz="1 0 0"/>
    <geometry><sphere radius="0.2"/></geometry></collision></link>
  <joint name="a" type="revolute"><parent link="post"/><child link="near"/>
    <axis xyz="0 0 1"/><limit lower="-3.2" upper="3.2"/></joint>
  <joint name="b" type="revolute"><parent link="near"/><child link="far"/>
    <origin xyz="1 0 0"/><axis xyz="0 0 1"/><limit lower="-3.2" upper="3.2"/></joint>
  <joint name="c" type="revolute"><parent link="far"/><child link="ball"/>
    <origin xyz="1 0 0"/><axis xyz="0 0 1"/><limit lower="-3.2" upper="3.2"/></joint>
</robot>)";

Scene ball_scene(const Vec3& center, double radius) {
  return {"s", {{"lamp", {Sphere{{9, 9, 9}, 0.1}}}, {"cup", {Sphere{center, radius}}}}};
}

std::vector<Contact> contacts_of(const Robot& robot, const Scene& scene, const Configuration& q,
                                 double margin) {
  return internal::find_contacts(robot, internal::LinkDistances(robot), scene, q, margin);
}

std::vector<Contact> fixed_contacts_of(const Robot& robot, const Scene& scene) {
  return internal::find_fixed_contacts(robot, internal::LinkDistances(robot), scene);
}

std::vector<std::string> named(const std::vector<Contact>& contacts) {
  std::vector<std::string> names;
  for (const Contact& contact : contacts) names.push_back(contact.link + " " + contact.other);
  return names;
}

using Names = std::vector<std::string>;

TEST_SUITE("unit") {
  TEST_CASE("a contact names the link and the obstacle and says how deep it is") {
    const Robot arm = require_parsed(kArm);
    const auto contacts =
        contacts_of(arm, ball_scene({1.5, 0.3, 0}, 0.27), Configuration{0, 0, 0}, 0);
    REQUIRE(contacts.size() == 1);
    CHECK(contacts[0].link == "far");
    CHECK(contacts[0].other == "cup");
    CHECK(!contacts[0].is_self);
    CHECK(contacts[0].distance == doctest::Approx(-0.02));
    CHECK_FALSE(contacts[0].may_be_deeper);
  }

  TEST_CASE("a contact that reaches the axis of a link may be deeper") {
    const Robot arm = require_parsed(kArm);
    const Box box{{Eigen::Matrix3d::Identity(), {1.5, 0, 0}}, {0.2, 0.5, 0.5}};
    const Scene scene{"scene", {{"box", {box}}}};
    const auto contacts = contacts_of(arm, scene, Configuration{0, 0, 0}, 0);
    REQUIRE(!contacts.empty());
    CHECK(contacts[0].may_be_deeper);
  }

  TEST_CASE("every link that touches is named") {
    const Robot arm = require_parsed(kArm);
    const auto contacts = contacts_of(arm, ball_scene({1, 0, 0}, 0.1), Configuration{0, 0, 0}, 0);
    CHECK(named(contacts) == Names{"near cup", "far cup"});
  }

  TEST_CASE("within the margin an obstacle counts, with the distance that it has") {
    const Robot arm = require_parsed(kArm);
    const Scene scene = ball_scene({0.5, 0, 0.5}, 0.1);
    const Configuration q = {0, 0, 0};
    CHECK(contacts_of(arm, scene, q, 0.34).empty());
    const auto contacts = contacts_of(arm, scene, q, 0.36);
    REQUIRE(named(contacts) == Names{"near cup"});
    CHECK(contacts[0].distance == doctest::Approx(0.35));
  }

  TEST_CASE("links joined by one joint are not in contact, even folded onto each other") {
    const Robot arm = require_parsed(kArm);
    CHECK(contacts_of(arm, {}, Configuration{0, kPi, 0}, 0).empty());
    CHECK(contacts_of(arm, {}, Configuration{0, 0, 0}, 10).empty());
  }

  TEST_CASE("surfaces that only just touch are not in contact") {
    const Robot arm = require_parsed(kArm);
    // The ball link is 0.2 m in radius about (3, 0, 0).
    const auto touches = [&](double x) {
      return !contacts_of(arm, ball_scene({x, 0, 0}, 0.8), Configuration{0, 0, 0}, 0).empty();
    };
    CHECK(touches(4 - 1e-12));
    CHECK(!touches(4 + 1e-12));
  }

  TEST_CASE("a link that touches another is named with it") {
    const Robot arm = require_parsed(kArm);
    // Folded back, the ball is at the near link's first joint; the post stands further below.
    const auto contacts = contacts_of(arm, {}, Configuration{0, kPi, kPi}, 0);
    REQUIRE(named(contacts) == Names{"near ball"});
    CHECK(contacts[0].is_self);
    CHECK(contacts[0].distance == doctest::Approx(-0.25));
  }

  TEST_CASE("what touches a link that stands still is told apart, because no motion changes it") {
    const Robot arm = require_parsed(kArm);
    const Scene scene = ball_scene({0.2, 0, -1}, 0.15);
    CHECK(contacts_of(arm, scene, Configuration{1, 1, 1}, 0).empty());
    CHECK(named(fixed_contacts_of(arm, scene)) == Names{"post cup"});
    CHECK(fixed_contacts_of(arm, scene)[0].distance == doctest::Approx(-0.05));
    CHECK(fixed_contacts_of(arm, ball_scene({0.2, 0, -1}, 0.05)).empty());
    CHECK(fixed_contacts_of(arm, ball_scene({0.5, 0, 0}, 0.05)).empty());
  }

  TEST_CASE("what may touch an obstacle is not in contact with it, whatever the margin") {
    const Robot arm = require_parsed(kArm);
    Scene scene = ball_scene({1, 0, 0}, 0.1);
    scene.obstacles[1].may_touch = {"far", "post"};
    CHECK(named(contacts_of(arm, scene, Configuration{0, 0, 0}, 0.2)) == Names{"near cup"});
    scene.obstacles[1].may_touch.push_back("near");
    CHECK(contacts_of(arm, scene, Configuration{0, 0, 0}, 0).empty());
    scene = ball_scene({0.2, 0, -1}, 0.15);
    scene.obstacles[1].may_touch = {"post"};
    CHECK(fixed_contacts_of(arm, scene).empty());
  }

  TEST_CASE("links without an approximation are not checked by exact geometry") {
    const Robot arm = require_parsed(kArm);
    Scene scene = ball_scene({1.5, 0.3, 0}, 0.27);
    scene.obstacles[1].exact_links = {"far"};
    CHECK(internal::obstacle_shapes(arm, scene)[1].exact_links.empty());
    const internal::LinkDistances links(arm);
    CHECK(internal::ExactPairs(arm, links, scene, 0).empty());
    CHECK(contacts_of(arm, scene, Configuration{0, 0, 0}, 0).size() == 1);
  }

  TEST_CASE("a link that is welded to a moving one does not stand still") {
    Robot::Parts parts;
    parts.name = "welded";
    parts.links = {
        {.name = "base"}, {.name = "arm"}, {.name = "tool", .spheres = {{{1, 0, 0}, 0.1}}}};
    for (int i = 0; i < 2; ++i) {
      Joint joint;
      joint.name = "joint" + std::to_string(i);
      joint.type = i == 0 ? JointType::continuous : JointType::fixed;
      joint.parent_link = i;
      joint.child_link = i + 1;
      parts.joints.push_back(joint);
    }
    const auto robot = require(make_robot(parts));
    const Scene scene = ball_scene({1, 0, 0}, 0.1);
    CHECK(named(contacts_of(robot, scene, Configuration{0}, 0)) == Names{"tool cup"});
    CHECK(fixed_contacts_of(robot, scene).empty());
  }

  TEST_CASE("an empty scene holds no contact") {
    const Robot arm = require_parsed(kArm);
    CHECK(contacts_of(arm, {}, Configuration{0, 1, 1}, 0).empty());
    CHECK(fixed_contacts_of(arm, {}).empty());
  }
}

TEST_SUITE("law") {
  TEST_CASE("contacts move with the world") {
    Rng rng(401);
    int found = 0;
    for (int i = 0; i < 30; ++i) {
      const Robot robot = random_robot(rng);
      const Scene scene = random_scene(robot, 5, rng, small_shape);
      const Transform X = random_pose(rng, 1.0);
      Robot::Parts parts{"moved", {{.name = "ground"}}, {}};
      for (Link link : robot.links()) parts.links.push_back(link);
      Joint mount;
      mount.name = "mount";
      mount.parent_link = 0;
      mount.child_link = 1;
      mount.origin = X;
      parts.joints.push_back(mount);
      for (Joint joint : robot.joints()) {
        ++joint.parent_link;
        ++joint.child_link;
        if (joint.mimic) ++joint.mimic->joint;
        parts.joints.push_back(joint);
      }
      RobotOptions options;
      for (int k = 0; k < robot.joint_count(); ++k)
        options.joints.push_back(robot.group_joint(k).name);
      for (const Joint& joint : robot.joints()) {
        if (joint.type == JointType::fixed || joint.mimic) continue;
        options.fixed_values[joint.name] = joint.fixed_value;
      }
      for (const std::string& name : options.joints) options.fixed_values.erase(name);
      const auto moved = require(make_robot(parts, options));
      Scene moved_scene = scene;
      for (Obstacle& obstacle : moved_scene.obstacles) {
        obstacle.shapes[0] = transformed(X, obstacle.shapes[0]);
      }
      for (int k = 0; k < 50; ++k) {
        const Configuration q = random_configuration(robot, rng);
        const auto here = contacts_of(robot, scene, q, 0.02);
        const auto there = contacts_of(moved, moved_scene, q, 0.02);
        INFO("seed 401, robot " << i << ", state " << k);
        REQUIRE(named(here) == named(there));
        for (std::size_t c = 0; c < here.size(); ++c) {
          REQUIRE(std::abs(here[c].distance - there[c].distance) < 1e-12);
          ++found;
        }
      }
    }
    CHECK(found > 300);
  }

  TEST_CASE("a state has contacts where its clearance is negative") {
    Rng rng(402);
    int in_contact = 0;
    for (int i = 0; i < 30; ++i) {
      const Robot robot = random_robot(rng);
      const Scene scene = random_scene(robot, 4, rng, small_shape);
      const double margin = i % 2 == 0 ? 0.0 : 0.1;
      for (int k = 0; k < 100; ++k) {
        const Configuration q = random_configuration(robot, rng);
        const auto contacts = contacts_of(robot, scene, q, margin);
        REQUIRE(contacts.empty() == (clearance(robot, scene, q, margin) >= 0));
        in_contact += contacts.empty() ? 0 : 1;
        for (const Contact& contact : contacts) {
          REQUIRE(contact.distance < (contact.is_self ? 0 : margin));
        }
      }
    }
    CHECK(in_contact > 300);
    CHECK(in_contact < 2700);
  }
}

bool touch(const Robot& robot, std::span<const double> q, int first, int second) {
  const internal::LinkDistances links(robot);
  return links.between_spheres(links.posed(robot.link_poses(q)), first, second, 0) <= 0;
}

Robot make_arm(std::vector<Sphere> spheres, std::vector<Capsule> capsules) {
  Robot::Parts parts = make_bare_chain(2);
  parts.links[0].spheres = {{{0, 0, 0}, 0.1}};
  parts.links[2].spheres = std::move(spheres);
  parts.links[2].capsules = std::move(capsules);
  return require(make_robot(parts));
}

TEST_SUITE("unit") {
  TEST_CASE("links without shapes touch nothing") {
    const Robot robot = make_arm({}, {});
    CHECK_FALSE(touch(robot, Configuration{0, 0}, 0, 2));
    CHECK_FALSE(touch(robot, Configuration{0, 0}, 0, 1));
  }
}

TEST_SUITE("law") {
  TEST_CASE("links touch where their shapes are closer than the radii") {
    // The shapes of l2 are around the point p in its frame, or between two points.
    const Vec3 p(-1, 0.3, 0.1);
    const Vec3 end(0.2, 0.3, 0.1);
    const Robot balls = make_arm({{end, 0.1}, {p, 0.25}}, {});
    const Robot capsule = make_arm({}, {{p, end, 0.25}});
    Rng rng(9);
    int touching = 0;
    for (int i = 0; i < 500; ++i) {
      const Configuration q = random_configuration(balls, rng);
      const Transform pose = balls.link_poses(q)[2];
      const bool do_balls_touch = touch(balls, q, 0, 2);
      const bool near = (pose * p).norm() < 0.35;
      CHECK(do_balls_touch == (near || (pose * end).norm() < 0.2));
      CHECK(touch(balls, q, 2, 0) == do_balls_touch);
      CHECK(touch(capsule, q, 0, 2) ==
            (segment_distance(pose * p, pose * end, Vec3::Zero(), Vec3::Zero()) < 0.35));
      touching += do_balls_touch ? 1 : 0;
    }
    CHECK(touching > 5);
    CHECK(touching < 300);
  }
}

}  // namespace
}  // namespace mneme::test

namespace mneme::internal {
namespace {

using test::require;

Clearance clearance_at(const Robot& robot, const Scene& scene, const Configuration& q) {
  const LinkDistances links(robot);
  return find_clearance(links, links.posed(robot.link_poses(q)), obstacle_shapes(robot, scene));
}

TEST_SUITE("unit") {
  TEST_CASE("Clearance is that of the nearest link and obstacle, and negative in contact") {
    const Robot robot = test::unit_arm(3);
    const Scene scene = make_circle_scene("two", {{2.5, 1, 0.4}, {-1, 0, 0.3}});
    const Clearance straight = clearance_at(robot, scene, Configuration{0, 0, 0});
    CHECK(straight.distance == doctest::Approx(0.6 - 0.001));
    CHECK(robot.links()[static_cast<std::size_t>(straight.link)].name == "link_3");
    CHECK(straight.obstacle == 0);
    const Clearance back = clearance_at(robot, scene, Configuration{M_PI, 0, 0});
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
    const auto robot = require(make_robot(std::move(parts)));
    const Scene scene = make_circle_scene("near the post", {{-0.3, 0, 0.1}});
    const Clearance clearance = clearance_at(robot, scene, Configuration{0});
    CHECK(clearance.distance == doctest::Approx(1.3 - 0.2));
    CHECK(robot.links()[static_cast<std::size_t>(clearance.link)].name == "arm");
  }

  TEST_CASE("Without obstacles clearance is infinite and has no names") {
    const Robot robot = test::unit_arm(2);
    const Scene empty;
    const Clearance clearance = clearance_at(robot, empty, Configuration{0, 0});
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
      box.pose.translation = Vec3{rng.uniform(-3, 3), rng.uniform(-3, 3), 0};
      box.half_extents = Vec3(0.3, 0.2, 0.1);
      scene.obstacles.push_back({"box", {box}});
      const auto checker = require(CollisionChecker::make(robot, scene));
      const Configuration q = test::random_configuration(robot, rng);
      const Clearance clearance = clearance_at(robot, scene, q);
      if (std::abs(clearance.distance) < 1e-6) continue;
      bool is_touching = false;
      for (const Contact& contact : checker.contacts(q)) is_touching |= !contact.is_self;
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

namespace mneme {
namespace {

using test::require;

const std::string kArm = R"(<robot name="arm">
  <link name="base"><collision><geometry><sphere radius="0.2"/></geometry></collision></link>
  <link name="upper"><collision><origin xyz="0 0 0.3"/><geometry><capsule radius="0.05" length="0.4"/>
    </geometry></collision></link>
  <link name="lower"><collision><origin xyz="0 0 0.2"/><geometry><sphere radius="0.1"/></geometry>
    </collision><collision><origin xyz="0 0 0.4"/><geometry><sphere radius="0.08"/></geometry>
    </collision></link>
  <joint name="a" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <joint name="b" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0 0 0.6"/>
    <axis xyz="1 1 0"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
</robot>)";

Scene random_scene(Rng& rng) {
  const auto point = [&] {
    return Vec3{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
  };
  const auto size = [&] { return rng.uniform(0.02, 0.3); };
  const Transform pose{rotation_from_rpy(3 * point()), point()};
  return {"s",
          {{"ball", {Sphere{point(), size()}}},
           {"box", {Box{pose, Vec3(size(), size(), size())}, Capsule{point(), point(), 0.03}}},
           {"can", {Cylinder{{rotation_from_rpy(3 * point()), point()}, size(), size()}}}}};
}

TEST_SUITE("law") {
  TEST_CASE("States are free exactly where the checker finds no contacts") {
    constexpr std::uint64_t kSeed = 5;
    const Robot robot = parse_robot(kArm, "arm.urdf").value();
    Rng rng(kSeed);
    int free_count = 0;
    constexpr int kScenes = 60;
    constexpr int kStates = 20;
    for (int i = 0; i < kScenes; ++i) {
      const Scene scene = random_scene(rng);
      const auto checker = require(CollisionChecker::make(robot, scene));
      for (int j = 0; j < kStates; ++j) {
        const Configuration q = test::random_configuration(robot, rng);
        INFO("seed " << kSeed << ", scene " << i << ", state " << j);
        const bool is_free = is_path_free(robot, scene, {q}, 1);
        REQUIRE(is_free == checker.contacts(q).empty());
        free_count += is_free ? 1 : 0;
      }
    }
    CHECK(free_count > kScenes * kStates / 10);
    CHECK(free_count < kScenes * kStates * 9 / 10);
  }
}

}  // namespace
}  // namespace mneme
