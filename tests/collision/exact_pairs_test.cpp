// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Pairs that are checked by exact geometry, against FCL.
#include "mneme/collision.h"
#include "mneme/spheres.h"

#include "collision/random_worlds.h"
#include "geometry/box_surface.h"
#include "geometry/fcl_shapes.h"

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace mneme::test {
namespace {

constexpr double kBeyond = 1e9;

/// A robot whose links are boxes in one sphere, which sticks out by decimetres, and one
/// that it carries. Their names are four letters and the box's number.
struct ApproximatedRobot {
  Robot robot;
  std::vector<Box> boxes;

  [[nodiscard]] const Box& box_of(const Link& link) const {
    return boxes[std::stoul(link.name.substr(4))];
  }
};

Box small_box_near_origin(Rng& rng) {
  const Vec3 half = random_vector(rng, 0.15).cwiseAbs() + Vec3::Constant(0.01);
  return {random_pose(rng, 0.1), half};
}

Link approximated_link(const std::string& name, const Box& box) {
  const double radius = box.half_extents.norm();
  Link link;
  link.name = name;
  link.spheres = {{box.pose.translation, radius}};
  link.approximation = SphereApproximation{
      {{}, std::make_shared<Parts<Triangle>>(surface_of(box)), 0}, 1, 0, radius};
  return link;
}

/// True if a link may touch another one: always, or one time in four.
bool may_touch_other(bool checks_links, Rng& rng) { return !checks_links || rng.index(4) == 0; }

Robot carrying_box(const Robot& bare, const Box& box, bool checks_links, Rng& rng) {
  const std::span<const Link> links = bare.links();
  const Link held = approximated_link("held" + std::to_string(links.size()), box);
  const std::uint32_t carrier = rng.index(static_cast<std::uint32_t>(links.size()));
  ApproximatedObject object{
      {held.name, links[carrier].name, {box}}, held.spheres, {}, held.approximation};
  for (const Link& link : links) {
    if (may_touch_other(checks_links, rng)) object.object.may_touch.push_back(link.name);
  }
  return require(bare.with_attached({object}));
}

/// All may touch each other, or only links next to each other and a few more.
ApproximatedRobot random_approximated_robot(Rng& rng, bool checks_links) {
  Robot::Parts parts;
  parts.name = "boxes";
  std::vector<Box> boxes;
  std::vector<std::string> moving;
  const int count = 3 + static_cast<int>(rng.index(3)) + (checks_links ? 1 : 0);
  for (int i = 0; i <= count; ++i) {
    boxes.push_back(small_box_near_origin(rng));
    parts.links.push_back(approximated_link("link" + std::to_string(i), boxes.back()));
    if (i == 0) continue;
    parts.joints.push_back(random_joint(i, rng));
    if (parts.joints.back().type == JointType::fixed)
      parts.joints.back().type = JointType::revolute;
    if (!follows_another(parts, moving, rng)) moving.push_back(parts.joints.back().name);
  }
  parts.allowed_pairs.emplace();
  for (const Link& a : parts.links) {
    for (const Link& b : parts.links) {
      const bool is_allowed =
          a.name.back() + 1 == b.name.back() || may_touch_other(checks_links, rng);
      if (a.name < b.name && is_allowed) parts.allowed_pairs->emplace_back(a.name, b.name);
    }
  }
  const auto robot = require(make_robot(parts));
  boxes.push_back(small_box_near_origin(rng));
  return {carrying_box(robot, boxes.back(), checks_links, rng), std::move(boxes)};
}

Scene random_obstacles(Rng& rng) {
  Scene scene;
  for (int i = 0; i < 4; ++i) {
    const Transform pose = random_pose(rng, 0.6);
    const Vec3 sizes = random_vector(rng, 0.12).cwiseAbs() + Vec3::Constant(0.02);
    const std::array<Shape, 4> shapes = {
        Sphere{pose.translation, sizes[0]}, Box{pose, sizes}, Cylinder{pose, sizes[0], sizes[1]},
        Capsule{pose.translation, pose.translation + sizes, sizes[2]}};
    Obstacle& obstacle = scene.obstacles.emplace_back();
    obstacle.name = std::to_string(i);
    obstacle.shapes = {shapes[rng.index(4)]};
  }
  return scene;
}

/// From a box, by code that has nothing to do with triangles.
double distance_from(const Box& box, const Shape& shape) {
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    return distance(sphere->center, box) - sphere->radius;
  }
  if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    return distance_to_segment(capsule->a, capsule->b, box) - capsule->radius;
  }
  return fcl_distance(box, shape);
}

/// Metres, at most 0 in contact: of pairs that are checked by exact geometry, and of spheres.
struct Gaps {
  double solids = kBeyond, spheres = kBeyond, ignored_spheres = kBeyond;
  [[nodiscard]] double least() const { return std::min(solids, spheres); }
};

/// Distances of moving links from obstacles.
Gaps obstacle_gaps_at(const ApproximatedRobot& robot_of_boxes, const Scene& scene,
                      const Configuration& q) {
  const Robot& robot = robot_of_boxes.robot;
  const std::vector<Transform> poses = robot.link_poses(q);
  const std::vector<bool> is_moving = internal::find_moving_links(robot);
  Gaps gaps;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!is_moving[i]) continue;
    const Link& link = robot.links()[i];
    const Shape box = transformed(poses[i], robot_of_boxes.box_of(link));
    const Sphere& sphere = link.spheres[0];
    for (const Obstacle& obstacle : scene.obstacles) {
      const double from_spheres =
          distance(poses[i] * sphere.center, obstacle.shapes[0]) - sphere.radius;
      const bool is_exact = std::ranges::count(obstacle.exact_links, link.name) > 0;
      double& least = is_exact ? gaps.ignored_spheres : gaps.spheres;
      least = std::min(least, from_spheres);
      if (!is_exact) continue;
      gaps.solids = std::min(gaps.solids, distance_from(std::get<Box>(box), obstacle.shapes[0]));
    }
  }
  return gaps;
}

/// Distances of links from each other; solids by FCL.
Gaps link_gaps_at(const ApproximatedRobot& robot_of_boxes, const Scene& scene,
                  const Configuration& q) {
  const Robot& robot = robot_of_boxes.robot;
  const std::vector<Transform> poses = robot.link_poses(q);
  Gaps gaps;
  for (const auto& [a, b] : robot.self_pairs()) {
    const auto i = static_cast<std::size_t>(a), k = static_cast<std::size_t>(b);
    const Link &one = robot.links()[i], &two = robot.links()[k];
    const Sphere &first = one.spheres[0], &second = two.spheres[0];
    const double from_spheres =
        (poses[i] * first.center - poses[k] * second.center).norm() - first.radius - second.radius;
    const bool is_exact =
        std::ranges::count(scene.exact_pairs, std::pair(one.name, two.name)) > 0 ||
        std::ranges::count(scene.exact_pairs, std::pair(two.name, one.name)) > 0;
    double& least = is_exact ? gaps.ignored_spheres : gaps.spheres;
    least = std::min(least, from_spheres);
    if (!is_exact) continue;
    gaps.solids =
        std::min(gaps.solids, fcl_distance(transformed(poses[i], robot_of_boxes.box_of(one)),
                                           transformed(poses[k], robot_of_boxes.box_of(two))));
  }
  return gaps;
}

Configuration configuration_of(std::span<const float> q) { return {q.begin(), q.end()}; }

/// From what links are checked by exact geometry.
enum class From { obstacles, links };

struct SolidWorld {
  From from;
  ApproximatedRobot robot_of_boxes;
  Scene scene = {};

  [[nodiscard]] const Robot& robot() const { return robot_of_boxes.robot; }
  [[nodiscard]] Gaps gaps_at(const Configuration& q) const {
    return from == From::links ? link_gaps_at(robot_of_boxes, scene, q)
                               : obstacle_gaps_at(robot_of_boxes, scene, q);
  }
  [[nodiscard]] Scene scene_of_spheres() const {
    Scene result = scene;
    result.exact_pairs.clear();
    for (Obstacle& obstacle : result.obstacles) obstacle.exact_links.clear();
    return result;
  }
};

SolidWorld random_solid_world(From from, Rng& rng) {
  SolidWorld world{from, random_approximated_robot(rng, from == From::links)};
  if (from == From::links) {
    check_links_exactly(world.scene, world.robot(), rng);
  } else {
    world.scene = random_obstacles(rng);
    check_obstacles_exactly(world.scene, world.robot(), rng);
  }
  return world;
}

struct StateTally {
  int free = 0, touching = 0;
  int only_spheres_touch = 0;  ///< of those free
};

/// Every instruction set's answer, that of exact distances, and verification's.
void compare_states(const SolidWorld& world, double margin, Rng& rng, StateTally& tally) {
  constexpr double kNear = 1e-4;
  // Margins are for obstacles.
  const double kept = world.from == From::obstacles ? margin : 0;
  const std::vector<float> rows = random_states(world.robot(), 60, rng);
  for (const Isa isa : available_isas()) {
    const auto checker =
        require_checker(world.robot(), world.scene, {.margin = margin, .isa = isa});
    const std::vector<std::uint8_t> is_valid = check_all(checker, rows);
    for (std::size_t i = 0; i < is_valid.size(); ++i) {
      const Configuration q = configuration_of(row(rows, i, world.robot()));
      const Gaps gaps = world.gaps_at(q);
      const bool is_free = gaps.least() > kept;
      // Where FCL finds contact it is one, however deep.
      if (std::abs(gaps.least() - kept) < kNear && gaps.solids > 0) continue;
      INFO("state " << i << ", " << gaps.least());
      REQUIRE((is_valid[i] != 0) == is_free);
      if (isa != Isa::scalar) continue;
      CHECK(checker.contacts(q).empty() == is_free);
      if (kept == 0) CHECK(is_path_free(world.robot(), world.scene, {q}, 1) == is_free);
      ++(is_free ? tally.free : tally.touching);
      tally.only_spheres_touch += is_free && gaps.ignored_spheres < kept ? 1 : 0;
    }
  }
}

struct MotionGaps : Gaps {
  double longest_contact = 0;  ///< radians, of solids at states that follow each other
};

/// The least of both at states of a motion.
MotionGaps least_gaps(const SolidWorld& world, const Configuration& from, const Configuration& to) {
  constexpr int kStates = 300;
  const Configuration delta = world.robot().difference(from, to);
  const double step = world.robot().distance(from, to) / kStates;
  MotionGaps least;
  double contact = 0;
  for (int k = 0; k <= kStates; ++k) {
    Configuration q = from;
    for (std::size_t j = 0; j < q.size(); ++j) q[j] += delta[j] * k / kStates;
    const Gaps gaps = world.gaps_at(q);
    least.solids = std::min(least.solids, gaps.solids);
    least.spheres = std::min(least.spheres, gaps.spheres);
    contact = gaps.solids > 0 ? 0 : contact + step;
    least.longest_contact = std::max(least.longest_contact, contact - step);
  }
  return least;
}

struct MotionTally {
  int free = 0, blocked = 0;   ///< by exact geometry; of those blocked contact is found
  int long_contact = 0;        ///< blocked for longer than states are apart
  int only_spheres_touch = 0;  ///< of those free
  int clear = 0;               ///< with room for what lies between states
};

void compare_motions(const SolidWorld& world, Rng& rng, MotionTally& tally) {
  // No link moves farther than this between two states.
  constexpr double kRoom = 0.06;
  const auto checker = require_checker(world.robot(), world.scene);
  const auto by_spheres = require_checker(world.robot(), world.scene_of_spheres());
  const std::vector<float> rows = random_states(world.robot(), 12, rng);
  CheckCounters counters;
  for (std::size_t i = 0; i + 1 < 12; ++i) {
    const auto from = row(rows, i, world.robot()), to = row(rows, i + 1, world.robot());
    const bool is_chain = checker.is_chain_valid({from.data(), 2 * from.size()}, counters);
    const bool is_motion = checker.is_motion_valid(from, to, counters);
    const bool is_sweep = checker.is_sweep_valid(from, to, counters, {.margin = 1e-4});
    const bool are_spheres_free = by_spheres.is_motion_valid(from, to, counters);
    const MotionGaps least = least_gaps(world, configuration_of(from), configuration_of(to));
    const bool touches = least.solids <= 0, is_clear = least.least() > kRoom;
    const bool is_long = least.longest_contact > 1.42 * checker.resolution();
    INFO("motion " << i);
    if (are_spheres_free) REQUIRE(is_motion);
    if (is_sweep) REQUIRE_FALSE(touches);
    if (is_chain || is_motion) REQUIRE_FALSE(is_long);
    if (is_clear) REQUIRE((is_chain && is_motion && is_sweep));
    tally.free += is_sweep ? 1 : 0;
    tally.blocked += touches ? 1 : 0;
    tally.long_contact += is_long ? 1 : 0;
    tally.clear += is_clear ? 1 : 0;
    tally.only_spheres_touch += is_sweep && !are_spheres_free ? 1 : 0;
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("a state is free if solids are, where they are checked, and spheres elsewhere") {
    for (const From from : {From::obstacles, From::links}) {
      Rng rng(91);
      StateTally tally;
      for (int i = 0; i < 50; ++i) {
        INFO("seed 91, from " << static_cast<int>(from) << ", world " << i);
        compare_states(random_solid_world(from, rng), i % 3 == 0 ? 0.02 : 0, rng, tally);
      }
      CHECK(tally.free > 400);
      CHECK(tally.touching > 400);
      CHECK(tally.only_spheres_touch > 120);
    }
  }

  TEST_CASE(
      "on a proven motion no solid touches, on a valid one for no longer than between states") {
    for (const From from : {From::obstacles, From::links}) {
      Rng rng(92);
      MotionTally tally;
      for (int i = 0; i < 50; ++i) {
        INFO("seed 92, from " << static_cast<int>(from) << ", world " << i);
        compare_motions(random_solid_world(from, rng), rng, tally);
      }
      CHECK(tally.free > 20);
      CHECK(tally.only_spheres_touch > 10);
      CHECK(tally.blocked > 40);
      CHECK(tally.long_contact > 30);
      CHECK(tally.clear > 10);
    }
  }
}

/// A plate that tilts on a spacer above a block: its underside reaches the block's edge at 0.08
/// rad, while the spheres of both overlap at any tilt.
constexpr std::string_view kSeesaw = R"(
<robot name="seesaw">
  <link name="block"><collision><geometry><box size="0.2 0.2 0.1"/></geometry></collision></link>
  <link name="spacer"><collision><origin xyz="0 0 0.004"/>
    <geometry><cylinder radius="0.015" length="0.008"/></geometry></collision></link>
  <link name="plate"><collision><geometry><box size="0.3 0.05 0.01"/></geometry></collision></link>
  <joint name="spin" type="revolute"><parent link="block"/><child link="spacer"/>
    <origin xyz="0 0 0.05"/><axis xyz="0 0 1"/>
    <limit lower="-0.5" upper="0.5" effort="1" velocity="1"/></joint>
  <joint name="tilt" type="revolute"><parent link="spacer"/><child link="plate"/>
    <origin xyz="0 0 0.013"/><axis xyz="0 1 0"/>
    <limit lower="-0.2" upper="0.2" effort="1" velocity="1"/></joint>
</robot>)";

TEST_SUITE("unit") {
  TEST_CASE("links whose spheres always overlap are checked by exact geometry") {
    for (const bool has_srdf : {false, true}) {
      const TemporaryDirectory files;
      write_file(files / "seesaw.urdf", std::string(kSeesaw));
      if (has_srdf) {
        write_file(files / "seesaw.srdf",
                   "<robot name='seesaw'><disable_collisions link1='block' link2='spacer'/>"
                   "<disable_collisions link1='spacer' link2='plate'/></robot>");
      }
      const auto loaded = require(load_approximated_robot(files / "seesaw.urdf"));
      REQUIRE(loaded.robot.exact_pairs().size() == 1);
      CHECK(loaded.robot.warnings().empty());
      CHECK(loaded.notes.back() ==
            "the spheres of links 'block' and 'plate' always overlap; they are checked by exact "
            "geometry");
      const CollisionChecker checker = require_checker(loaded.robot, Scene{});
      const auto is_valid = [&](double tilt) { return checker.is_valid(Configuration{0, tilt}); };
      // The plate's underside: 0.013 - 0.1 tan(tilt) - 0.005 / cos(tilt) above the block.
      CHECK(is_valid(0));
      CHECK(is_valid(0.079));
      CHECK_FALSE(is_valid(0.081));
      CHECK_FALSE(is_valid(-0.2));
      CHECK(checker.contacts(Configuration{0, 0.2}).size() == 1);
      CHECK(checker.is_motion_valid(Configuration{-0.5, 0.05}, Configuration{0.5, -0.05}));
      CHECK_FALSE(checker.is_motion_valid(Configuration{0, 0.07}, Configuration{0.3, 0.09}));
    }
  }

  TEST_CASE("links whose spheres alone often overlap are checked by exact geometry") {
    const TemporaryDirectory files;
    const auto replace = [](std::string text, std::string_view from, std::string_view to) {
      return text.replace(text.find(from), from.size(), to);
    };
    const std::string higher = replace(std::string(kSeesaw), "0 0 0.013", "0 0 0.04");
    write_file(files / "seesaw.urdf",
               replace(higher, "\"-0.2\" upper=\"0.2\"", "\"-0.4\" upper=\"0.4\""));
    const auto loaded = require(load_approximated_robot(files / "seesaw.urdf"));
    REQUIRE(loaded.robot.exact_pairs().size() == 1);
    CHECK(loaded.notes.back() ==
          "the spheres of links 'block' and 'plate' often overlap; they are checked by exact "
          "geometry");
    const CollisionChecker checker = require_checker(loaded.robot, Scene{});
    // The plate's underside: 0.04 - 0.1 tan(tilt) - 0.005 / cos(tilt) above the block.
    CHECK(checker.is_valid(Configuration{0, 0.33}));
    CHECK_FALSE(checker.is_valid(Configuration{0, 0.338}));
  }

  TEST_CASE("pairs that are checked by exact geometry may have a smaller margin than others") {
    const TemporaryDirectory files;
    std::string low(kSeesaw);
    low.replace(low.find("0 0 0.013"), 9, "0 0 0.006");  // a millimetre above the block
    write_file(files / "seesaw.urdf", low);
    const auto loaded = require(load_approximated_robot(files / "seesaw.urdf"));
    const CollisionChecker checker = require_checker(loaded.robot, Scene{});
    const std::array<float, 4> rows = {-0.5f, 0, 0.5f, 0};
    const std::span<const float> from(rows.data(), 2), to(rows.data() + 2, 2);
    CheckCounters counters;
    for (const double most : {0.0012, 0.0008}) {
      const MotionDetail detail{1, 0.003, most};
      CHECK(checker.is_motion_valid(from, to, counters, detail) == (most < 0.001));
      CHECK(checker.is_chain_valid(rows, counters, detail) == (most < 0.001));
    }
    CHECK_FALSE(checker.is_motion_valid(from, to, counters, {1, 0.003}));
  }

  TEST_CASE("an obstacle that is checked by the exact geometry of an unknown link is refused") {
    Scene scene = make_circle_scene("one", {{3, 3, 1}});
    scene.obstacles[0].exact_links = {"hand"};
    CHECK(require_error(CollisionChecker::make(planar8(), scene)).message ==
          "obstacle 'circle_1' is checked by the exact geometry of 'hand', but robot 'planar8' has "
          "no link "
          "and no attached object of this name");
  }

  TEST_CASE("a scene with a pair of an unknown link is refused") {
    Scene scene{"two", {}};
    scene.exact_pairs = {{planar8().links()[0].name, "hand"}};
    CHECK(require_error(CollisionChecker::make(planar8(), scene)).message ==
          "scene 'two' has a pair checked by exact geometry of 'hand', but robot 'planar8' has no "
          "link and "
          "no attached object of this name");
  }

  TEST_CASE("a capsule that lies wholly inside the exact geometry of another link touches it") {
    const Box box{{}, {0.3, 0.3, 0.3}};
    for (const double out : {0.0, 0.55}) {
      Robot::Parts parts;
      parts.name = "held";
      Link pin;
      pin.name = "pin";
      pin.capsules = {{{out, 0, -0.1}, {out, 0, 0.1}, 0.02}};
      parts.links = {approximated_link("case", box), pin};
      Joint& joint = parts.joints.emplace_back();
      joint.name = "slide";
      joint.type = JointType::prismatic;
      joint.parent_link = 0;
      joint.child_link = 1;
      joint.lower = -0.1;
      joint.upper = 0.1;
      parts.allowed_pairs.emplace();
      const auto robot = require(make_robot(parts));
      Scene scene;
      scene.exact_pairs = {{"case", "pin"}};
      const CollisionChecker checker = require_checker(robot, scene);
      const std::vector<double> q = {0.0};
      CHECK(checker.is_valid(q) == (out > 0));
      CHECK(checker.contacts(q).empty() == (out > 0));
    }
  }

  TEST_CASE("pairs of links without an approximation are checked as ever") {
    Rng rng(95);
    const Robot robot = planar8();
    Scene scene;
    for (const auto& [a, b] : robot.self_pairs()) {
      scene.exact_pairs.emplace_back(robot.links()[static_cast<std::size_t>(a)].name,
                                     robot.links()[static_cast<std::size_t>(b)].name);
    }
    const std::vector<float> rows = random_states(robot, 200, rng);
    CHECK(check_all(require_checker(robot, scene), rows) ==
          check_all(require_checker(robot, Scene{}), rows));
  }

  TEST_CASE("links without an approximation are checked as ever") {
    Scene scene = make_circle_scene("one", {{5, 0, 1}});
    const Configuration straight(8, 0.0);
    const Robot robot = planar8();
    CHECK_FALSE(require_checker(robot, scene).is_valid(straight));
    for (const Link& link : robot.links()) scene.obstacles[0].exact_links.push_back(link.name);
    CHECK_FALSE(require_checker(robot, scene).is_valid(straight));
  }
}

}  // namespace
}  // namespace mneme::test
