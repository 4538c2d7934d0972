// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tables/joint_reach.h"
#include "tables/make_tables.h"
#include "collision/random_worlds.h"
#include "tables/shape_groups.h"
#include "geometry/random_shapes.h"
#include "support/support.h"

#include <algorithm>
#include <vector>

namespace mneme::test {
namespace {

/// A row of links along x, joined at distances of 1 by joints of the given types about z (revolute
/// ones within `limit` of 0), or along z within `limit`.
Robot row_of_links(const std::vector<JointType>& types, double limit) {
  Robot::Parts parts;
  parts.name = "row";
  parts.links.push_back({.name = "link0", .spheres = {{{0, 0, 0}, 0.1}}});
  for (std::size_t i = 0; i < types.size(); ++i) {
    parts.links.push_back({.name = "link" + std::to_string(i + 1), .spheres = {{{0, 0, 0}, 0.1}}});
    Joint joint;
    joint.name = "joint" + std::to_string(i);
    joint.type = types[i];
    joint.parent_link = static_cast<int>(i);
    joint.child_link = static_cast<int>(i) + 1;
    joint.axis = Vec3::UnitZ();
    joint.origin.translation = Vec3(1, 0, 0);
    joint.lower = -limit;
    joint.upper = limit;
    parts.joints.push_back(joint);
  }
  return require(make_robot(parts));
}

struct Carried {
  int frame = 0;
  std::vector<Sphere> spheres;
};

bool meet(const Robot& robot, const Carried& a, const Carried& b) {
  const auto tables = require(internal::make_robot_tables(robot));
  const internal::Linkage there(robot, tables, a.frame, b.frame);
  const internal::Linkage back(robot, tables, b.frame, a.frame);
  const bool result = there.can_meet(a.spheres, b.spheres);
  CHECK(result == back.can_meet(b.spheres, a.spheres));
  return result;
}

std::vector<Sphere> random_spheres(Rng& rng) {
  std::vector<Sphere> spheres(1 + rng.index(4));
  for (Sphere& sphere : spheres) sphere = {random_vector(rng, 1), rng.uniform(0.02, 0.2)};
  return spheres;
}

double gap(const std::vector<Transform>& poses, const Carried& a, const Carried& b) {
  double least = 1e9;
  for (const Sphere& p : a.spheres) {
    for (const Sphere& q : b.spheres) {
      const Vec3 between = poses[static_cast<std::size_t>(a.frame)] * p.center -
                           poses[static_cast<std::size_t>(b.frame)] * q.center;
      least = std::min(least, between.norm() - p.radius - q.radius);
    }
  }
  return least;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("limits decide whether a joint can fold one sphere onto another") {
    const Carried base{0, {{{0, 0, 0}, 0.1}}}, tip{1, {{{1, 0, 0}, 0.1}}};
    const auto revolute = JointType::revolute;
    CHECK(meet(row_of_links({revolute}, 3.1), base, tip));
    CHECK_FALSE(meet(row_of_links({revolute}, 2.8), base, tip));
    CHECK(meet(row_of_links({JointType::continuous}, 0), base, tip));
    // The same two links further along, where other joints move both.
    const Carried second{1, {{{0, 0, 0}, 0.1}}}, third{2, {{{1, 0, 0}, 0.1}}};
    CHECK_FALSE(meet(row_of_links({revolute, revolute, revolute}, 2.8), second, third));
  }

  TEST_CASE("sliding joints reach as far as their limits") {
    const Carried base{0, {{{1, 0, 1}, 0.1}}}, slider{1, {{{0, 0, 0}, 0.1}}};
    CHECK(meet(row_of_links({JointType::prismatic}, 0.9), base, slider));
    CHECK_FALSE(meet(row_of_links({JointType::prismatic}, 0.7), base, slider));
  }

  TEST_CASE("spheres that nothing moves against each other either touch or never do") {
    const Robot robot = row_of_links({JointType::revolute}, 1);
    CHECK(meet(robot, {1, {{{0, 0, 0}, 0.1}}}, {1, {{{0.15, 0, 0}, 0.1}}}));
    CHECK_FALSE(meet(robot, {1, {{{0, 0, 0}, 0.1}}}, {1, {{{0.25, 0, 0}, 0.1}}}));
  }

  TEST_CASE("more joints than are looked at rule nothing out") {
    const Robot robot = row_of_links(std::vector(3, JointType::revolute), 0.01);
    CHECK(meet(robot, {0, {{{0, 0, 0}, 0.1}}}, {3, {{{1, 0, 0}, 0.1}}}));
  }
}

TEST_SUITE("law") {
  TEST_CASE("spheres that cannot meet do not meet in any random configuration") {
    Rng rng(11);
    int apart = 0, together = 0;
    for (int round = 0; round < 200; ++round) {
      const double limit = rng.uniform(0.2, 3);
      const std::array kinds = {JointType::revolute, JointType::continuous, JointType::prismatic};
      const Robot robot = row_of_links({kinds.at(rng.index(3)), kinds.at(rng.index(3))}, limit);
      const Carried a{0, random_spheres(rng)}, b{2, random_spheres(rng)};
      const bool can_meet = meet(robot, a, b);
      double least = 1e9;
      for (int i = 0; i < 1000; ++i) {
        least = std::min(least, gap(robot.link_poses(random_configuration(robot, rng)), a, b));
      }
      if (least < 0) CHECK(can_meet);
      apart += !can_meet;
      together += can_meet;
    }
    CHECK(apart > 30);
    CHECK(together > 30);
  }
}

namespace {

std::vector<Capsule> random_capsules(std::size_t count, Rng& rng) {
  std::vector<Capsule> shapes;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 a = random_vector(rng, 1.0);
    const bool is_sphere = rng.index(2) == 0;
    const Vec3 b = is_sphere ? a : Vec3(a + random_vector(rng, 0.5));
    shapes.push_back({a, b, rng.uniform(0.01, 0.3)});
  }
  return shapes;
}

double reach_of(const Capsule& shape, const Vec3& from) {
  return std::max((shape.a - from).norm(), (shape.b - from).norm()) + shape.radius;
}

TEST_SUITE("unit") {
  TEST_CASE("the ball around a single shape is its own") {
    const std::vector<Capsule> sphere = {{{1, 2, 3}, {1, 2, 3}, 0.5}};
    CHECK(internal::enclosing_ball(sphere).center.isApprox(Vec3(1, 2, 3)));
    CHECK(internal::enclosing_ball(sphere).radius == doctest::Approx(0.5));
    const std::vector<Capsule> capsule = {{{0, 0, 0}, {2, 0, 0}, 0.5}};
    CHECK(internal::enclosing_ball(capsule).center.isApprox(Vec3(1, 0, 0)));
    CHECK(internal::enclosing_ball(capsule).radius == doctest::Approx(1.5));
  }

  TEST_CASE("the ball around two balls touches both, or is the one that contains the other") {
    const Sphere small{{0, 0, 0}, 0.5}, far{{4, 0, 0}, 1}, large{{0.25, 0, 0}, 2};
    CHECK(internal::enclosing_ball(small, far).center.isApprox(Vec3(2.25, 0, 0)));
    CHECK(internal::enclosing_ball(small, far).radius == doctest::Approx(2.75));
    CHECK(internal::enclosing_ball(small, large).radius == 2);
    CHECK(internal::enclosing_ball(large, small).radius == 2);
  }

  TEST_CASE("no shapes make no groups") { CHECK(internal::sort_into_groups({}, 4).empty()); }

  TEST_CASE("neighbours share a group") {
    std::vector<Capsule> shapes;
    for (const double x : {5.0, 0.2, 5.1, 0.0, 0.1, 5.2})
      shapes.push_back({{x, 0, 0}, {x, 0, 0}, 0.1});
    CHECK(internal::sort_into_groups(shapes, 3) == std::vector<std::size_t>{3, 6});
    for (std::size_t i = 0; i < 6; ++i) CHECK((shapes[i].a.x() < 1) == (i < 3));
  }
}

TEST_SUITE("law") {
  TEST_CASE("the ball contains all shapes and is not much larger than any ball that does") {
    Rng rng(521);
    for (int i = 0; i < 300; ++i) {
      const auto shapes = random_capsules(1 + rng.index(12), rng);
      const Sphere ball = internal::enclosing_ball(shapes);
      double farthest = 0, widest = 0;
      for (const Capsule& a : shapes) {
        farthest = std::max(farthest, reach_of(a, ball.center));
        for (const Capsule& b : shapes) {
          widest = std::max({widest, reach_of(b, a.a) + a.radius, reach_of(b, a.b) + a.radius});
        }
      }
      INFO("seed 521, set " << i);
      REQUIRE(ball.radius >= farthest - 1e-12);
      // By Jung's theorem for points; the ball found may exceed the smallest one a little.
      REQUIRE(ball.radius <= widest * 0.6124 * 1.1);
    }
  }

  TEST_CASE("groups keep all shapes, in groups that are full but for the rest") {
    Rng rng(522);
    for (std::size_t count = 1; count < 60; ++count) {
      for (const std::size_t most : {1, 4, 8}) {
        auto shapes = random_capsules(count, rng);
        auto before = shapes;
        const auto ends = internal::sort_into_groups(shapes, most);
        REQUIRE(ends.size() == (count + most - 1) / most);
        REQUIRE(ends.back() == count);
        for (std::size_t i = 0, begin = 0; i < ends.size(); begin = ends[i++]) {
          REQUIRE(ends[i] > begin);
          REQUIRE(ends[i] - begin <= most);
        }
        const auto by_place = [](const Capsule& a, const Capsule& b) { return a.a.x() < b.a.x(); };
        std::sort(shapes.begin(), shapes.end(), by_place);
        std::sort(before.begin(), before.end(), by_place);
        for (std::size_t i = 0; i < count; ++i) REQUIRE(shapes[i].a == before[i].a);
      }
    }
  }
}

}  // namespace
}  // namespace mneme::test
