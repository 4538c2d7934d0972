// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels against the exact contacts in double precision, and those against FCL.
#include "mneme/collision.h"

#include "collision/random_worlds.h"
#include "geometry/fcl_shapes.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace mneme::test {
namespace {

constexpr double kExactTolerance = 1e-4;
constexpr double kFclTolerance = 1e-6;
/// Between a capsule and a box FCL iterates, and now and then stops this far above the distance.
constexpr double kFclEarlyStop = 1e-4;

/// A kind of obstacle: to add a shape, add a row.
struct RandomObstacle {
  const char* name;
  Shape (*make)(Rng&);
};
constexpr std::array<RandomObstacle, 5> kKinds = {{{"sphere", small_sphere},
                                                   {"box", small_box},
                                                   {"capsule", small_capsule},
                                                   {"cylinder", small_cylinder},
                                                   {"any shape", small_shape}}};

struct Tally {
  int free = 0, in_contact = 0, self_only = 0;
};

bool is_self_only(const std::vector<Contact>& contacts) {
  return !contacts.empty() && contacts.front().is_self;
}

/// Compares every instruction set's answer for every row with the exact contacts.
void compare_with_contacts(const Robot& robot, const Scene& scene, double margin,
                           const std::vector<float>& rows, Tally& tally) {
  const CollisionChecker exact = require_checker(robot, scene, {.margin = margin});
  std::vector<bool> is_free;
  const std::size_t count = rows.size() / static_cast<std::size_t>(robot.joint_count());
  for (std::size_t i = 0; i < count; ++i) {
    const auto q = row(rows, i, robot);
    const auto contacts = exact.contacts(Configuration(q.begin(), q.end()));
    is_free.push_back(contacts.empty());
    ++(contacts.empty() ? tally.free : tally.in_contact);
    tally.self_only += is_self_only(contacts) ? 1 : 0;
  }
  for (const Isa isa : available_isas()) {
    const auto checker = require_checker(robot, scene, {.margin = margin, .isa = isa});
    const auto is_valid = check_all(checker, rows);
    for (std::size_t i = 0; i < count; ++i) {
      if ((is_valid[i] != 0) == is_free[i]) continue;
      const double gap = clearance(robot, scene, row(rows, i, robot), margin);
      INFO(to_string(isa) << ", state " << i << ": clearance " << gap);
      REQUIRE(std::abs(gap) < kExactTolerance);
    }
  }
}

/// A URDF with what the reader knows: turned base, odd axes, prismatic and fixed joints, branches.
constexpr const char* kTwoArms = R"(<robot name="two_arms">
  <link name="world"/>
  <link name="base"><collision><origin xyz="0 0 0.1" rpy="0 0 0"/>
    <geometry><sphere radius="0.15"/></geometry></collision></link>
  <link name="upper"><collision><origin xyz="0.2 0 0" rpy="0 1.5707963267948966 0"/>
    <geometry><capsule radius="0.05" length="0.4"/></geometry></collision></link>
  <link name="lower">
    <collision><origin xyz="0 0 0.15" rpy="0.3 0.2 0.1"/>
      <geometry><capsule radius="0.04" length="0.3"/></geometry></collision>
    <collision><origin xyz="0 0 0.4" rpy="0 0 0"/>
      <geometry><sphere radius="0.09"/></geometry></collision></link>
  <link name="hand"><collision><origin xyz="0.05 0.02 0" rpy="1 2 3"/>
    <geometry><capsule radius="0.03" length="0.2"/></geometry></collision></link>
  <link name="mast"><collision><origin xyz="0 0 0.2" rpy="0 0 0"/>
    <geometry><capsule radius="0.06" length="0.4"/></geometry></collision></link>
  <link name="boom"><collision><origin xyz="0 0.3 0" rpy="1.5707963267948966 0 0"/>
    <geometry><capsule radius="0.04" length="0.6"/></geometry></collision></link>
  <joint name="mount" type="fixed"><parent link="world"/><child link="base"/>
    <origin xyz="0.1 -0.2 0.3" rpy="0.4 -0.5 0.6"/></joint>
  <joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/>
    <origin xyz="0.2 0 0.1" rpy="0 0.7 0"/><axis xyz="1 2 -3"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/>
    <origin xyz="0.45 0 0" rpy="0 0 0"/><axis xyz="0 0 -1"/>
    <limit lower="-2.9" upper="2.9"/></joint>
  <joint name="slide" type="prismatic"><parent link="lower"/><child link="hand"/>
    <origin xyz="0 0.05 0.5" rpy="0.1 0 0"/><axis xyz="0.3 0 1"/>
    <limit lower="-0.2" upper="0.3"/></joint>
  <joint name="lift" type="prismatic"><parent link="base"/><child link="mast"/>
    <origin xyz="-0.25 0.1 0" rpy="0 0 0"/><axis xyz="0 0 1"/><limit lower="0" upper="0.5"/></joint>
  <joint name="swing" type="revolute"><parent link="mast"/><child link="boom"/>
    <origin xyz="0 0 0.45" rpy="0 0 2"/><axis xyz="0 -1 0.2"/><limit lower="-3" upper="1"/></joint>
</robot>)";

/// A collision shape at a random place in a cube.
std::string random_shapes(Rng& rng, double side, const char* geometry) {
  const Vec3 at = random_vector(rng, side), turn = random_vector(rng, 3);
  return fmt::format(
      R"(<collision><origin xyz="{} {} {}" rpy="{} {} {}"/><geometry>{}</geometry></collision>)",
      at.x(), at.y(), at.z(), turn.x(), turn.y(), turn.z(), geometry);
}

/// A hand of three turns in front of a stand, both of scattered spheres and capsules.
Robot scattered_robot(Rng& rng, int spheres, int capsules) {
  std::string shapes[2];
  for (std::string& link : shapes) {
    for (int i = 0; i < spheres; ++i)
      link += random_shapes(rng, 0.4, R"(<sphere radius="0.006"/>)");
    for (int i = 0; i < capsules; ++i) {
      link += random_shapes(rng, 0.4, R"(<capsule radius="0.006" length="0.3"/>)");
    }
  }
  const std::string limits = R"(<limit lower="-3" upper="3"/></joint>)";
  return require_parsed(
      R"(<robot name="scattered"><link name="stand">)" + shapes[0] +
      R"(</link><link name="a"/><link name="b"/><link name="hand">)" + shapes[1] +
      R"(</link>
  <joint name="one" type="revolute"><parent link="stand"/><child link="a"/>
    <origin xyz="0.3 0 0"/><axis xyz="0 0 1"/>)" +
      limits +
      R"(<joint name="two" type="revolute"><parent link="a"/><child link="b"/>
    <origin xyz="0.3 0 0"/><axis xyz="0 1 0"/>)" +
      limits +
      R"(<joint name="three" type="revolute"><parent link="b"/><child link="hand"/>
    <origin xyz="0.3 0 0"/><axis xyz="1 0 0"/>)" +
      limits + "</robot>");
}

/// All that touches, by FCL: the names of a link and of the other thing.
class FclWorld {
 public:
  FclWorld(const Robot& robot, const Scene& scene, const Configuration& q)
      : robot_(robot), scene_(scene), poses_(robot.link_poses(q)) {}

  /// The least distance of FCL: 0 in contact.
  double link_to_obstacle(std::size_t link, std::size_t obstacle) const {
    return least(shapes_of(link), scene_.obstacles[obstacle].shapes);
  }
  double link_to_link(std::size_t first, std::size_t second) const {
    return least(shapes_of(first), shapes_of(second));
  }

 private:
  std::vector<Shape> shapes_of(std::size_t link) const {
    std::vector<Shape> shapes;
    for (const Sphere& s : robot_.links()[link].spheres) {
      shapes.push_back(transformed(poses_[link], s));
    }
    for (const Capsule& c : robot_.links()[link].capsules) {
      shapes.push_back(transformed(poses_[link], c));
    }
    return shapes;
  }
  static double least(const std::vector<Shape>& first, const std::vector<Shape>& second) {
    double result = std::numeric_limits<double>::infinity();
    for (const Shape& a : first) {
      for (const Shape& b : second) result = std::min(result, fcl_distance(a, b));
    }
    return result;
  }

  const Robot& robot_;
  const Scene& scene_;
  std::vector<Transform> poses_;
};

/// Distances by contacts() for each pair that it names; with a margin it names near pairs, too.
std::map<std::pair<std::string, std::string>, double> gaps_of(
    const std::vector<Contact>& contacts) {
  std::map<std::pair<std::string, std::string>, double> gaps;
  for (const Contact& contact : contacts) gaps[{contact.link, contact.other}] = contact.distance;
  return gaps;
}

TEST_SUITE("oracle") {
  TEST_CASE("kernels agree with exact contacts on planar states") {
    const Robot robot = planar8();
    Rng rng(201);
    Tally tally;
    for (int i = 0; i < 50; ++i) {
      const Scene scene = random_circles(1 + i % 8, rng);
      INFO("seed 201, scene " << i);
      const double margin = i % 3 == 0 ? 0.1 : 0.0;
      const auto rows = random_states(robot, 2000, rng, i % 2 == 0 ? 1.0 : 0.3);
      compare_with_contacts(robot, scene, margin, rows, tally);
    }
    CHECK(tally.free > 10000);
    CHECK(tally.in_contact > 10000);
    CHECK(tally.self_only > 1000);
  }

  TEST_CASE("kernels agree with exact contacts of random robots with every kind of obstacle") {
    Rng rng(202);
    for (const RandomObstacle& kind : kKinds) {
      Tally tally;
      for (int i = 0; i < 10; ++i) {
        const Robot robot = random_robot(rng);
        const Scene scene = random_scene(robot, 4, rng, kind.make);
        INFO("seed 202, " << kind.name << ", robot " << i);
        compare_with_contacts(robot, scene, 0, random_states(robot, 1000, rng), tally);
      }
      CAPTURE(kind.name);
      CHECK(tally.free > 1000);
      CHECK(tally.in_contact > 1000);
    }
  }

  TEST_CASE("kernels agree with exact contacts of a robot from URDF with two arms") {
    Rng rng(203);
    const Robot robot = require_parsed(kTwoArms);
    const Robot reordered = require_parsed(
        kTwoArms,
        {.joints = {"swing", "slide", "elbow", "shoulder"}, .fixed_values = {{"lift", 0.3}}});
    for (const RandomObstacle& kind : kKinds) {
      for (const Robot& arms : {robot, reordered}) {
        Tally tally;
        const Scene scene = random_scene(arms, 8, rng, kind.make);
        INFO("seed 203, " << kind.name << ", " << arms.joint_count() << " joints");
        compare_with_contacts(arms, scene, 0.01, random_states(arms, 10000, rng), tally);
        CHECK(tally.free > 500);
        CHECK(tally.in_contact > 500);
        CHECK(tally.self_only > 100);
      }
    }
  }

  TEST_CASE("kernels agree with exact contacts of links with few and with hundreds of shapes") {
    Rng rng(209);
    Tally tally;
    for (const auto& [spheres, capsules] :
         {std::pair{700, 30}, {600, 0}, {0, 90}, {40, 10}, {20, 2}, {4, 1}}) {
      const Robot robot = scattered_robot(rng, spheres, capsules);
      const std::string link =
          fmt::format("{} spheres and {} capsules a link, seed 209", spheres, capsules);
      CAPTURE(link);
      const int count = spheres > 100 ? 300 : 1000;
      compare_with_contacts(robot, Scene{}, 0, random_states(robot, count, rng), tally);
    }
    CHECK(tally.free > 1000);
    CHECK(tally.self_only > 1000);
  }

  TEST_CASE("composite obstacles are the sum of their shapes") {
    Rng rng(204);
    Tally tally;
    for (int i = 0; i < 10; ++i) {
      const Robot robot = random_robot(rng);
      Scene scene = random_scene(robot, 6, rng, small_shape);
      for (std::size_t k = 1; k < scene.obstacles.size(); ++k) {
        scene.obstacles[0].shapes.push_back(scene.obstacles[k].shapes[0]);
      }
      scene.obstacles.resize(std::min<std::size_t>(scene.obstacles.size(), 1));
      INFO("seed 204, robot " << i);
      compare_with_contacts(robot, scene, 0, random_states(robot, 500, rng), tally);
    }
    CHECK(tally.free > 500);
    CHECK(tally.in_contact > 500);
  }

  TEST_CASE("exact contacts with obstacles are those of FCL") {
    Rng rng(205);
    int touching = 0, apart = 0;
    for (int i = 0; i < 60; ++i) {
      const Robot robot = random_robot(rng);
      const Scene scene =
          random_scene(robot, 8, rng, kKinds.at(static_cast<std::size_t>(i) % 5).make);
      const CollisionChecker checker = require_checker(robot, scene);
      for (int k = 0; k < 40; ++k) {
        const Configuration q = random_configuration(robot, rng);
        const auto gaps = gaps_of(checker.contacts(q));
        const FclWorld world(robot, scene, q);
        const auto poses = robot.link_poses(q);
        for (std::size_t link = 0; link < robot.links().size(); ++link) {
          for (std::size_t other = 0; other < scene.obstacles.size(); ++other) {
            const Obstacle& obstacle = scene.obstacles[other];
            const auto found = gaps.find({robot.links()[link].name, obstacle.name});
            const double distance = world.link_to_obstacle(link, other);
            ++(distance > 0 ? apart : touching);
            if ((found != gaps.end()) == (distance == 0)) continue;
            const double gap = gap_between(capsules_of(robot.links()[link], poses[link]), obstacle);
            INFO("seed 205, robot " << i << ", state " << k << ": FCL " << distance << ", exact "
                                    << gap);
            REQUIRE(std::min(distance, std::abs(gap)) < kFclTolerance);
          }
        }
      }
    }
    CHECK(touching > 500);
    CHECK(apart > 1000);
  }

  TEST_CASE("exact contacts of links with links are those of FCL") {
    Rng rng(206);
    int touching = 0, apart = 0;
    for (int i = 0; i < 60; ++i) {
      const Robot robot = random_robot(rng);
      const CollisionChecker checker = require_checker(robot, {});
      for (int k = 0; k < 40; ++k) {
        const Configuration q = random_configuration(robot, rng);
        const auto gaps = gaps_of(checker.contacts(q));
        const FclWorld world(robot, checker.scene(), q);
        for (const auto& [a, b] : robot.self_pairs()) {
          const auto first = static_cast<std::size_t>(a), second = static_cast<std::size_t>(b);
          const auto found = gaps.find({robot.links()[first].name, robot.links()[second].name});
          const double distance = world.link_to_link(first, second);
          ++(distance > 0 ? apart : touching);
          if ((found != gaps.end()) == (distance == 0)) continue;
          INFO("seed 206, robot " << i << ", state " << k << ": FCL " << distance);
          REQUIRE(std::min(distance, found == gaps.end() ? 1.0 : std::abs(found->second)) <
                  kFclTolerance);
        }
      }
    }
    CHECK(touching > 300);
    CHECK(apart > 1000);
  }

  TEST_CASE("distances of contacts within a margin are those of FCL") {
    Rng rng(207);
    constexpr double kMargin = 0.3;
    int compared = 0, early_stops = 0;
    for (int i = 0; i < 60; ++i) {
      const Robot robot = random_robot(rng);
      const Scene scene =
          random_scene(robot, 8, rng, kKinds.at(static_cast<std::size_t>(i) % 3).make);
      const CollisionChecker checker = require_checker(robot, scene, {.margin = kMargin});
      const std::vector<bool> is_moving = internal::find_moving_links(robot);
      for (int k = 0; k < 40; ++k) {
        const Configuration q = random_configuration(robot, rng);
        const auto gaps = gaps_of(checker.contacts(q));
        const FclWorld world(robot, scene, q);
        for (std::size_t link = 0; link < robot.links().size(); ++link) {
          if (!is_moving[link]) continue;
          for (std::size_t other = 0; other < scene.obstacles.size(); ++other) {
            const auto found = gaps.find({robot.links()[link].name, scene.obstacles[other].name});
            const double distance = world.link_to_obstacle(link, other);
            INFO("seed 207, robot " << i << ", state " << k << ": FCL " << distance);
            if (found == gaps.end()) {
              REQUIRE(distance > kMargin - kFclTolerance);
            } else {
              const double excess = distance - std::max(0.0, found->second);
              REQUIRE(excess > -kFclTolerance);
              REQUIRE(excess < kFclEarlyStop);
              early_stops += excess > kFclTolerance ? 1 : 0;
              ++compared;
            }
          }
        }
      }
    }
    CHECK(compared > 2000);
    CHECK(early_stops < compared / 100);
  }
}

}  // namespace
}  // namespace mneme::test
