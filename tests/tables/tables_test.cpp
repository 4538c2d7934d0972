// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tables/make_tables.h"
#include "collision/random_worlds.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

namespace mneme::test {
namespace {

using internal::RobotTables;

RobotTables require_tables(const Robot& robot) {
  return require(internal::make_robot_tables(robot));
}

/// `count` links about z, each with a sphere, after `fixed` links with a sphere that stand still.
Result<Robot> long_chain(int count, int fixed) {
  Robot::Parts parts;
  parts.name = "snake";
  parts.links.push_back({.name = "link0", .spheres = {{{0, 0, 0}, 0.01}}});
  for (int i = 1; i <= count + fixed; ++i) {
    parts.links.push_back({.name = "link" + std::to_string(i), .spheres = {{{0, 0, 0}, 0.01}}});
    Joint joint;
    joint.name = "joint" + std::to_string(i);
    joint.type = i <= fixed ? JointType::fixed : JointType::continuous;
    joint.parent_link = i - 1;
    joint.child_link = i;
    joint.axis = Vec3::UnitZ();
    joint.origin.translation = Vec3(0.1, 0, 0);
    parts.joints.push_back(joint);
  }
  return make_robot(parts);
}

/// Returns the frame of a tip that turns about `axis`.
internal::FrameRow frame_about(const Vec3& axis) {
  Robot::Parts parts;
  parts.name = "pointer";
  parts.links = {{.name = "base"}, {.name = "tip", .spheres = {{{1, 0, 0}, 0.1}}}};
  Joint joint;
  joint.name = "turn";
  joint.type = JointType::continuous;
  joint.parent_link = 0;
  joint.child_link = 1;
  joint.axis = axis;
  parts.joints.push_back(joint);
  const auto robot = require(make_robot(parts));
  const RobotTables tables = require_tables(robot);
  REQUIRE(tables.frames.size() == 1);
  return tables.frames[0];
}

/// `count` teeth on a bar along x, a metre from each other, that turns about z.
Robot comb(int count) {
  Robot::Parts parts;
  parts.name = "comb";
  parts.links.push_back({.name = "base"});
  parts.links.push_back({.name = "bar"});
  parts.joints.emplace_back();
  for (int i = 1; i <= count; ++i) {
    parts.links.push_back({.name = "tooth" + std::to_string(i), .spheres = {{{0, 0, 0}, 0.05}}});
    parts.joints.emplace_back().origin.translation = Vec3(i, 0, 0);
  }
  for (std::size_t i = 0; i < parts.joints.size(); ++i) {
    Joint& joint = parts.joints[i];
    joint.name = "joint" + std::to_string(i);
    joint.type = i == 0 ? JointType::continuous : JointType::fixed;
    joint.axis = Vec3::UnitZ();
    joint.parent_link = i == 0 ? 0 : 1;
    joint.child_link = static_cast<int>(i) + 1;
  }
  return require(make_robot(parts));
}

Vec3 vector_of(const float* p) { return {p[0], p[1], p[2]}; }

Eigen::Matrix3d matrix_of(const float* r) {
  Eigen::Matrix3d m;
  for (int i = 0; i < 9; ++i) m(i / 3, i % 3) = r[i];
  return m;
}

/// Poses of the root and of the frames in the root's frame, from the rows alone.
std::vector<Transform> frame_poses(const RobotTables& tables, const Configuration& q) {
  std::vector<Transform> poses(1);
  for (const internal::FrameRow& row : tables.frames) {
    const Transform& parent = poses.at(static_cast<std::size_t>(row.parent));
    const double value = row.multiplier * q[static_cast<std::size_t>(row.joint)] + row.offset;
    Transform motion;
    if (row.is_prismatic) {
      motion.translation = value * Vec3::UnitZ();
    } else {
      motion.rotation = rotation_about(Vec3::UnitZ(), value);
    }
    poses.push_back(parent * Transform{matrix_of(row.rotation), vector_of(row.translation)} *
                    motion);
  }
  return poses;
}

/// Spheres and capsules of some groups in the root's frame, without those that fill up a group; a
/// sphere is a capsule of length 0.
std::vector<Capsule> shapes_of(const RobotTables& tables, const Transform& X, int group_begin,
                               int group_end) {
  std::vector<Capsule> shapes;
  for (int g = group_begin; g < group_end; ++g) {
    const internal::GroupRow& group = tables.groups.at(static_cast<std::size_t>(g));
    if (group.is_capsule) {
      const internal::CapsuleRow& c = tables.capsules.at(static_cast<std::size_t>(group.begin));
      const Vec3 a = vector_of(c.a), b = a + vector_of(c.along);
      CHECK(c.inverse_length2 * (b - a).squaredNorm() == doctest::Approx(1));
      shapes.push_back({X * a, X * b, c.radius});
      continue;
    }
    for (int i = 0; i < internal::kGroupSize; ++i) {
      const internal::Ball& s = tables.spheres.at(static_cast<std::size_t>(group.begin + i));
      const Capsule sphere{X * vector_of(s.center), X * vector_of(s.center), s.radius};
      const bool is_repeated =
          i > 0 && sphere.a == shapes.back().a && sphere.radius == shapes.back().radius;
      if (!is_repeated) shapes.push_back(sphere);
    }
  }
  return shapes;
}

const Transform& pose_of(const internal::BodyRow& body, const std::vector<Transform>& poses) {
  return poses.at(static_cast<std::size_t>(body.frame));
}

/// True if two lists hold the same shapes in any order, up to rounding.
bool is_same(const std::vector<Capsule>& first, const std::vector<Capsule>& second) {
  const auto count_in = [](const std::vector<Capsule>& list, const Capsule& shape) {
    return std::ranges::count_if(list, [&](const Capsule& other) {
      return (other.a - shape.a).norm() < 1e-5 && (other.b - shape.b).norm() < 1e-5 &&
             std::abs(other.radius - shape.radius) < 1e-6;
    });
  };
  return first.size() == second.size() && std::ranges::all_of(first, [&](const Capsule& shape) {
           return count_in(first, shape) == count_in(second, shape);
         });
}

/// A group is checked against the shapes of this link, found by where its first shape is.
int link_of_group(const RobotTables& tables, const Robot& robot, const Configuration& q, int body,
                  int group) {
  const auto poses = frame_poses(tables, q);
  const auto own = shapes_of(tables, pose_of(tables.bodies[static_cast<std::size_t>(body)], poses),
                             group, group + 1);
  const auto link_poses = robot.link_poses(q);
  for (std::size_t i = 0; i < robot.links().size(); ++i) {
    for (const Capsule& shape : capsules_of(robot.links()[i], link_poses[i])) {
      if ((shape.a - own.at(0).a).norm() < 1e-5 && (shape.b - own.at(0).b).norm() < 1e-5) {
        return static_cast<int>(i);
      }
    }
  }
  return -1;
}

TEST_SUITE("unit") {
  TEST_CASE("each joint of the group makes one frame, and what does not move makes none") {
    const auto robot = require(long_chain(3, 2));
    const auto tables = require_tables(robot);
    CHECK(tables.joint_count == 3);
    REQUIRE(tables.frames.size() == 3);
    CHECK(tables.frames[0].parent == 0);
    CHECK(tables.frames[1].parent == 1);
    CHECK(tables.frames[2].joint == 2);
    CHECK(vector_of(tables.frames[0].translation).isApprox(Vec3(0.3, 0, 0), 1e-6));
    CHECK(tables.frames[0].turn == internal::Turn::none);
    CHECK(tables.moving_count == 3);
    CHECK(tables.bodies.size() > 3);
    CHECK(tables.bodies.size() <= 6);
  }

  TEST_CASE("bodies stand from tip to root, so that the likeliest contact is met first") {
    const RobotTables tables = require_tables(planar8());
    REQUIRE(tables.bodies.size() == 8);
    CHECK(tables.moving_count == 8);
    for (std::size_t i = 1; i < 8; ++i) CHECK(tables.bodies[i].frame < tables.bodies[i - 1].frame);
    CHECK(tables.body_pairs.size() == 21);
    CHECK(tables.group_pairs.size() == 21);
  }

  TEST_CASE("an axis of the coordinates needs no more than a permutation, whatever its sign") {
    for (int i = 0; i < 3; ++i) {
      for (const double sign : {-1.0, 1.0}) {
        const internal::FrameRow frame = frame_about(sign * Vec3::Unit(i));
        CHECK(frame.turn == (i == 2 ? internal::Turn::none : internal::Turn::permutation));
        CHECK(frame.multiplier == static_cast<float>(sign));
      }
    }
  }

  TEST_CASE("an axis that leans by a millionth is not one of the coordinates") {
    for (int i = 0; i < 3; ++i) {
      for (const double sign : {-1.0, 1.0}) {
        const Vec3 leaning = (sign * Vec3::Unit(i) + 1e-6 * Vec3::Unit((i + 1) % 3)).normalized();
        CHECK(frame_about(leaning).turn == internal::Turn::general);
        const Vec3 rounded = sign * Vec3::Unit(i) + 1e-12 * Vec3::Unit((i + 1) % 3);
        CHECK(frame_about(rounded).turn != internal::Turn::general);
      }
    }
  }

  TEST_CASE("welded links that lie together share a body, others do not") {
    for (const double distance : {0.05, 0.5}) {
      Robot::Parts parts;
      parts.name = "hand";
      parts.links = {{.name = "base"},
                     {.name = "palm", .spheres = {{{0, 0, 0}, 0.1}}},
                     {.name = "finger", .spheres = {{{0, 0, 0}, 0.1}}}};
      for (int i = 0; i < 2; ++i) {
        Joint joint;
        joint.name = "joint" + std::to_string(i);
        joint.type = i == 0 ? JointType::continuous : JointType::fixed;
        joint.parent_link = i;
        joint.child_link = i + 1;
        joint.origin.translation = Vec3(distance, 0, 0);
        parts.joints.push_back(joint);
      }
      const auto robot = require(make_robot(parts));
      const RobotTables tables = require_tables(robot);
      CHECK(tables.bodies.size() == (distance < 0.1 ? 1 : 2));
      CHECK(tables.moving_count == std::ssize(tables.bodies));
      CHECK(tables.groups.size() == 2);
      CHECK(tables.clusters.size() == tables.bodies.size());
    }
  }

  TEST_CASE("links without shapes have no row") {
    Robot::Parts parts;
    parts.name = "bare";
    parts.links = {{.name = "a"}, {.name = "b"}, {.name = "c", .spheres = {{{0, 0, 0}, 1}}}};
    for (int i = 0; i < 2; ++i) {
      Joint joint;
      joint.name = "joint" + std::to_string(i);
      joint.type = JointType::continuous;
      joint.parent_link = i;
      joint.child_link = i + 1;
      parts.joints.push_back(joint);
    }
    const auto robot = require(make_robot(parts));
    const auto tables = require_tables(robot);
    CHECK(tables.frames.size() == 2);
    REQUIRE(tables.bodies.size() == 1);
    CHECK(tables.bodies[0].frame == 2);
    CHECK(tables.moving_count == 1);
  }

  TEST_CASE("a robot with more joints than the kernels hold is refused, one with as many is not") {
    const auto most = require(long_chain(internal::kMaxFrames, 100));
    CHECK(internal::make_robot_tables(most).has_value());
    for (const int joints : {internal::kMaxFrames + 1, 1000}) {
      const auto more = require(long_chain(joints, 0));
      const Error error = require_error(internal::make_robot_tables(more));
      CHECK(error.code == ErrorCode::unsupported);
      CHECK(contains(error.message, "'snake'"));
      CHECK(contains(error.message, "64"));
    }
  }

  TEST_CASE("a robot as large as the kernels hold is checked to its last link") {
    const auto robot = require(long_chain(internal::kMaxFrames, 0));
    const Configuration straight(internal::kMaxFrames, 0.0);
    const Scene scene = make_circle_scene("s", {{0.1 * internal::kMaxFrames, 0, 0.05}});
    for (const Isa isa : available_isas()) {
      CHECK(!require_checker(robot, scene, {.isa = isa}).is_valid(straight));
      CHECK(require_checker(robot, {}, {.isa = isa}).is_valid(straight));
    }
  }

  TEST_CASE("each of many links that one joint carries is checked, also where bodies are merged") {
    for (const int count : {internal::kMaxFrames + 8, internal::kMaxBodies + 8}) {
      const Robot robot = comb(count);
      CHECK(require_tables(robot).moving_count == std::min(count, internal::kMaxBodies));
      for (int tooth = 1; tooth <= count; ++tooth) {
        const Scene scene = make_circle_scene("s", {{0.0, static_cast<double>(tooth), 0.01}});
        for (const Isa isa : available_isas()) {
          const CollisionChecker checker = require_checker(robot, scene, {.isa = isa});
          CHECK(checker.is_valid(Configuration{0}));
          CHECK(!checker.is_valid(Configuration{kPi / 2}));
          CHECK(!checker.is_motion_valid(Configuration{kPi / 2 - 0.1}, Configuration{kPi / 2}));
        }
      }
    }
  }
}

TEST_SUITE("law") {
  TEST_CASE("the tables put every shape where the robot's own kinematics do") {
    Rng rng(501);
    for (int i = 0; i < 200; ++i) {
      const Robot robot = random_robot(rng);
      const RobotTables tables = require_tables(robot);
      const Configuration q = random_configuration(robot, rng);
      const auto poses = frame_poses(tables, q);
      std::vector<Capsule> own, expected;
      for (const internal::BodyRow& body : tables.bodies) {
        const auto shapes =
            shapes_of(tables, pose_of(body, poses), body.group_begin, body.group_end);
        own.insert(own.end(), shapes.begin(), shapes.end());
      }
      const auto link_poses = robot.link_poses(q);
      for (std::size_t k = 0; k < robot.links().size(); ++k) {
        const auto shapes = capsules_of(robot.links()[k], link_poses[k]);
        expected.insert(expected.end(), shapes.begin(), shapes.end());
      }
      INFO("seed 501, robot " << i);
      REQUIRE(is_same(own, expected));
    }
  }

  TEST_CASE("bodies that move come first, tips before roots") {
    Rng rng(504);
    for (int i = 0; i < 100; ++i) {
      const RobotTables tables = require_tables(random_robot(rng));
      for (std::size_t k = 0; k < tables.bodies.size(); ++k) {
        REQUIRE((tables.bodies[k].frame > 0) == (static_cast<int>(k) < tables.moving_count));
        if (k > 0) REQUIRE(tables.bodies[k].frame <= tables.bodies[k - 1].frame);
      }
    }
  }

  TEST_CASE("balls contain what they are around, of groups, clusters and bodies") {
    Rng rng(502);
    for (int i = 0; i < 200; ++i) {
      const RobotTables tables = require_tables(random_robot(rng));
      const auto require_inside = [&](const internal::Ball& ball, int begin, int end) {
        const Vec3 center = vector_of(ball.center);
        double reach = 0;
        for (const Capsule& shape : shapes_of(tables, {}, begin, end)) {
          reach = std::max({reach, (shape.a - center).norm() + shape.radius,
                            (shape.b - center).norm() + shape.radius});
        }
        REQUIRE(ball.radius >= reach);
        REQUIRE(ball.radius < reach + 1e-5);
      };
      for (const internal::BodyRow& body : tables.bodies) {
        require_inside(body.ball, body.group_begin, body.group_end);
        int next = body.group_begin;
        for (int c = body.cluster_begin; c < body.cluster_end; ++c) {
          const internal::ClusterRow& cluster = tables.clusters[static_cast<std::size_t>(c)];
          REQUIRE(cluster.begin == next);
          REQUIRE(cluster.end - cluster.begin <= internal::kClusterSize);
          next = cluster.end;
          require_inside(cluster.ball, cluster.begin, cluster.end);
          for (int g = cluster.begin; g < cluster.end; ++g) {
            const internal::GroupRow& group = tables.groups[static_cast<std::size_t>(g)];
            REQUIRE(group.cluster == c);
            REQUIRE((!group.is_capsule || cluster.end == cluster.begin + 1));
          }
        }
        REQUIRE(next == body.group_end);
        for (int g = body.group_begin; g < body.group_end; ++g) {
          require_inside(tables.groups[static_cast<std::size_t>(g)].ball, g, g + 1);
        }
      }
    }
  }

  TEST_CASE("pairs that the tables leave out touch in no configuration, and they name no others") {
    Rng rng(503);
    std::size_t named = 0, kept = 0;
    for (int i = 0; i < 200; ++i) {
      const Robot robot = random_robot(rng);
      const RobotTables tables = require_tables(robot);
      const Configuration q = random_configuration(robot, rng);
      std::set<std::pair<int, int>> pairs;
      for (const internal::BodyPairRow& bodies : tables.body_pairs) {
        REQUIRE(bodies.first < tables.moving_count);
        for (int k = bodies.begin; k < bodies.end; ++k) {
          const auto& row = tables.group_pairs.at(static_cast<std::size_t>(k));
          const int first = link_of_group(tables, robot, q, bodies.first, row.first);
          for (int g = row.second_begin; g < row.second_end; ++g) {
            const int second = link_of_group(tables, robot, q, bodies.second, g);
            pairs.insert(std::minmax(first, second));
          }
        }
      }
      const std::set<std::pair<int, int>> wanted(robot.self_pairs().begin(),
                                                 robot.self_pairs().end());
      REQUIRE(std::ranges::includes(wanted, pairs));
      named += wanted.size();
      kept += pairs.size();
      for (int trial = 0; trial < 20; ++trial) {
        const std::vector<Transform> poses = robot.link_poses(random_configuration(robot, rng));
        for (const auto& pair : wanted) {
          if (pairs.contains(pair)) continue;
          const auto a = static_cast<std::size_t>(pair.first);
          const auto b = static_cast<std::size_t>(pair.second);
          REQUIRE(gap_between(capsules_of(robot.links()[a], poses[a]),
                              capsules_of(robot.links()[b], poses[b])) > 0);
        }
      }
    }
    CHECK(kept < named);
    CHECK(2 * kept > named);
  }
}

using internal::ObstacleKind;
using internal::SceneTables;

SceneTables require_tables(const Scene& scene) {
  return require(internal::make_scene_tables(scene));
}

Scene scene_of(const std::vector<Shape>& shapes) { return {"s", {{"thing", shapes}}}; }

/// Boxes that are turned by `angle` about z, and one that is turned about x as well.
std::vector<Shape> turned_boxes(double angle) {
  const Eigen::Matrix3d turn = rotation_about(Vec3::UnitZ(), angle);
  const Eigen::Matrix3d odd = rotation_about(Vec3::UnitX(), 0.3);
  return {Box{{turn, {1, 0, 0}}, {0.1, 0.2, 0.3}},
          Box{{turn * rotation_about(Vec3::UnitZ(), kPi / 2), {0, 1, 0}}, {0.1, 0.2, 0.3}},
          Box{{turn * odd, {0, 0, 1}}, {0.1, 0.2, 0.3}}};
}

TEST_SUITE("unit") {
  TEST_CASE("obstacles become rows of their kind, composite ones several") {
    const Transform X{rotation_about(Vec3::UnitY(), kPi / 2), {1, 2, 3}};
    const Scene scene{"s",
                      {{"a", {Sphere{{1, 2, 3}, 0.5}, Box{X, {1, 2, 4}}}},
                       {"b", {Capsule{{0, 0, 0}, {1, 1, 1}, 0.25}, Cylinder{X, 0.5, 3}}},
                       {"c", {Cylinder{{}, 0.5, 3}}}}};
    const SceneTables tables = require_tables(scene);
    REQUIRE(tables.obstacles.size() == 5);
    CHECK(tables.obstacles[0].kind == ObstacleKind::sphere);
    CHECK(vector_of(tables.obstacles[0].center) == Vec3(1, 2, 3));
    CHECK(tables.obstacles[0].rounding == 0.5f);
    CHECK(tables.obstacles[1].kind == ObstacleKind::aligned_box);
    CHECK(vector_of(tables.obstacles[1].half_extents).isApprox(Vec3(4, 2, 1), 1e-6));
    CHECK(tables.obstacles[2].kind == ObstacleKind::capsule);
    CHECK(vector_of(tables.obstacles[2].along) == Vec3(1, 1, 1));
    CHECK(tables.obstacles[2].rounding == 0.25f);
    CHECK(tables.obstacles[3].kind == ObstacleKind::cylinder);
    CHECK(vector_of(tables.obstacles[3].half_extents) == Vec3(0.5, 0.5, 1.5));
    CHECK(matrix_of(tables.obstacles[3].rotation).isApprox(X.rotation.transpose(), 1e-6));
    CHECK(tables.obstacles[4].kind == ObstacleKind::upright_cylinder);
    CHECK(tables.obstacles[4].rounding == 0);
  }

  TEST_CASE("the scene's axes are those of most boxes") {
    for (const double angle : {0.4, kPi / 4, 2.0}) {
      const SceneTables tables = require_tables(scene_of(turned_boxes(angle)));
      const Eigen::Matrix3d turn = rotation_about(Vec3::UnitZ(), angle);
      CHECK(tables.obstacles[0].kind == ObstacleKind::aligned_box);
      CHECK(tables.obstacles[1].kind == ObstacleKind::aligned_box);
      CHECK(tables.obstacles[2].kind == ObstacleKind::box);
      CHECK(vector_of(tables.obstacles[0].center)
                .isApprox(matrix_of(tables.rotation) * Vec3(1, 0, 0), 1e-6));
      const Eigen::Matrix3d in_scene = matrix_of(tables.rotation) * turn;
      CHECK(in_scene.cwiseAbs().rowwise().maxCoeff().isApprox(Vec3::Ones(), 1e-6));
    }
  }

  TEST_CASE("the robot's own axes are those of a scene without boxes, or of one that has them") {
    auto shapes = turned_boxes(0);
    CHECK(matrix_of(require_tables(scene_of(shapes)).rotation).isIdentity());
    shapes = {Cylinder{{rotation_about(Vec3::UnitX(), 0.3), {1, 0, 0}}, 0.1, 0.2}};
    CHECK(matrix_of(require_tables(scene_of(shapes)).rotation).isIdentity());
    CHECK(matrix_of(require_tables({}).rotation).isIdentity());
  }

  TEST_CASE("bounds fill whole blocks, the rest of which nothing overlaps") {
    for (const std::size_t count : {1, 16, 17}) {
      const std::vector<Shape> shapes(count, Sphere{{1, 2, 3}, 0.5});
      const SceneTables tables = require_tables(scene_of(shapes));
      for (std::size_t axis = 0; axis < 3; ++axis) {
        REQUIRE(tables.lower[axis].size() == (count == 17 ? 32 : 16));
        REQUIRE(tables.upper[axis].size() == tables.lower[axis].size());
        for (std::size_t i = count; i < tables.lower[axis].size(); ++i) {
          CHECK(tables.lower[axis][i] > 1e30f);
          CHECK(tables.upper[axis][i] < -1e30f);
        }
      }
    }
    CHECK(require_tables({}).lower[0].empty());
  }

  TEST_CASE("an obstacle without shapes is an error that names it") {
    const Error error = require_error(internal::make_scene_tables({"s", {{"ghost", {}}}}));
    CHECK(contains(error.message, "'ghost'"));
  }
}

TEST_SUITE("law") {
  TEST_CASE("no configuration brings a body closer to obstacles than its clearance") {
    Rng rng(29);
    int known_count = 0;
    for (int round = 0; round < rounds(40); ++round) {
      INFO("round ", round);
      const Robot robot = random_robot(rng);
      const RobotTables tables = require_tables(robot);
      const Scene scene = random_scene(robot, 6, rng, small_shape);
      const auto made = require(internal::make_scene_tables(scene));
      const std::vector<float> clearances = internal::find_clearances(tables, made);
      REQUIRE(clearances.size() == static_cast<std::size_t>(tables.moving_count));
      // A checker whose margin is a body's clearance sees no contact of that body.
      for (int i = 0; i < tables.moving_count; ++i) {
        const float clearance = clearances[static_cast<std::size_t>(i)];
        if (clearance <= 0) continue;
        ++known_count;
        const internal::BodyRow& body = tables.bodies[static_cast<std::size_t>(i)];
        std::set<std::string> links;
        for (int g = body.group_begin; g < body.group_end; ++g) {
          const int link = tables.link_of_group[static_cast<std::size_t>(g)];
          links.insert(robot.links()[static_cast<std::size_t>(link)].name);
        }
        const CollisionChecker checker = require_checker(robot, scene, {.margin = clearance});
        const std::vector<float> states = random_states(robot, 20, rng);
        for (std::size_t k = 0; k < 20; ++k) {
          const std::span<const float> q = row(states, k, robot);
          for (const Contact& contact : checker.contacts(Configuration(q.begin(), q.end()))) {
            CHECK((contact.is_self || !links.contains(contact.link)));
          }
        }
      }
    }
    CHECK(known_count > 10);
  }

  TEST_CASE("a body on the first joint keeps clear of what is far from the joint") {
    const RobotTables tables = require_tables(*long_chain(2, 0));
    Scene scene = make_circle_scene("", {{0.1f, 1.0f, 0.2f}});
    const auto made = require(internal::make_scene_tables(scene));
    const std::vector<float> clearances = internal::find_clearances(tables, made);
    REQUIRE(clearances.size() == 2);
    // Tips first. The second joint is 0.1 m from the first.
    CHECK(clearances[1] == doctest::Approx(1.0 - 0.2 - 0.01).epsilon(1e-3));
    CHECK(clearances[0] == doctest::Approx(1.0 - 0.2 - 0.11).epsilon(1e-3));
  }

  TEST_CASE("the bounds of an obstacle contain it, and touch it") {
    Rng rng(511);
    for (int i = 0; i < 400; ++i) {
      std::vector<Shape> shapes = turned_boxes(rng.uniform(-kPi, kPi));
      shapes.push_back(random_shape(i % kShapeKinds, rng));
      const SceneTables tables = require_tables(scene_of(shapes));
      // The rotation of floats is not orthogonal enough for so long a view.
      const Eigen::Quaterniond turn(matrix_of(tables.rotation));
      const Transform X_SW{turn.normalized().toRotationMatrix(), Vec3::Zero()};
      const Shape shape = transformed(X_SW, shapes.back());
      const auto bound = [&](const auto& bounds, int axis) {
        return static_cast<double>(bounds[static_cast<std::size_t>(axis)].at(shapes.size() - 1));
      };
      INFO("seed 511, shape " << i);
      for (int axis = 0; axis < 3; ++axis) {
        for (const double side : {-1.0, 1.0}) {
          const double at = side > 0 ? bound(tables.upper, axis) : bound(tables.lower, axis);
          // Seen from so far away, the shape ends in a plane.
          constexpr double kFar = 1e5;
          Vec3 eye = bounding_sphere(shape).center;
          const double reach = side * (at - eye[axis]);
          eye[axis] += side * kFar;
          REQUIRE(distance(eye, shape) > kFar - reach);
          REQUIRE(distance(eye, shape) < kFar - reach + 1e-3);
        }
      }
    }
  }
}

}  // namespace
}  // namespace mneme::test
