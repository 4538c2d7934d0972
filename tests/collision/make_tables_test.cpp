// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "collision/make_tables.h"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "collision/collision_kernels.h"
#include "collision/random_worlds.h"

namespace mneme::test {
namespace {

internal::RobotTables require_tables(const Robot& robot) {
  auto tables = internal::make_robot_tables(robot);
  REQUIRE_MESSAGE(tables.has_value(), (tables ? "" : tables.error().message));
  return *tables;
}

/// `count` links about z, each with a sphere, after `fixed` links with a sphere that stand still.
Result<Robot> long_chain(int count, int fixed) {
  Robot::Parts parts;
  parts.name = "snake";
  parts.links.push_back({"link0", -1, {{{0, 0, 0}, 0.01}}, {}});
  for (int i = 1; i <= count + fixed; ++i) {
    parts.links.push_back({"link" + std::to_string(i), -1, {{{0, 0, 0}, 0.01}}, {}});
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

Vec3 vector_of(const float* p) { return {p[0], p[1], p[2]}; }

Eigen::Matrix3d matrix_of(const float* r) {
  Eigen::Matrix3d m;
  for (int i = 0; i < 9; ++i) m(i / 3, i % 3) = r[i];
  return m;
}

/// Poses of the frames in the root's frame, from the rows alone.
std::vector<Transform> frame_poses(const internal::RobotTables& tables, const Configuration& q) {
  std::vector<Transform> poses;
  for (const internal::FrameRow& row : tables.frames) {
    const Transform parent =
        row.parent < 0 ? Transform{} : poses.at(static_cast<std::size_t>(row.parent));
    const double value = q[static_cast<std::size_t>(row.joint)];
    Transform motion;
    if (row.is_prismatic) {
      motion.translation = value * Vec3::UnitZ();
    } else {
      motion.rotation = rotation_about(Vec3::UnitZ(), value);
    }
    const Eigen::Matrix3d turned = matrix_of(row.rotation);
    poses.push_back(parent * Transform{turned, vector_of(row.translation)} * motion);
  }
  return poses;
}

Transform pose_of(const internal::LinkRow& row, const std::vector<Transform>& frames) {
  return row.frame < 0 ? Transform{} : frames.at(static_cast<std::size_t>(row.frame));
}

TEST_SUITE("unit") {
  TEST_CASE("each joint of the group makes one frame, and what does not move makes none") {
    const auto robot = long_chain(3, 2);
    REQUIRE(robot.has_value());
    const auto tables = require_tables(*robot);
    CHECK(tables.joint_count == 3);
    REQUIRE(tables.frames.size() == 3);
    CHECK(tables.frames[0].parent == -1);
    CHECK(tables.frames[1].parent == 0);
    CHECK(tables.frames[2].joint == 2);
    CHECK(vector_of(tables.frames[0].translation).isApprox(Vec3(0.3, 0, 0), 1e-6));
    CHECK(!tables.frames[0].is_rotated);
    CHECK(tables.links.size() == 3);
    CHECK(tables.fixed_links.size() == 3);
  }

  TEST_CASE("moving links stand from tip to root, so that the likeliest contact is met first") {
    const auto tables = require_tables(planar8());
    REQUIRE(tables.links.size() == 8);
    for (std::size_t i = 1; i < 8; ++i) CHECK(tables.links[i].link < tables.links[i - 1].link);
    CHECK(tables.pairs.size() == 21);
    CHECK(tables.fixed_pairs.empty());
  }

  TEST_CASE("links without shapes have no row") {
    Robot::Parts parts;
    parts.name = "bare";
    parts.links = {{"a", -1, {}, {}}, {"b", -1, {}, {}}, {"c", -1, {{{0, 0, 0}, 1}}, {}}};
    for (int i = 0; i < 2; ++i) {
      Joint joint;
      joint.name = "joint" + std::to_string(i);
      joint.type = JointType::continuous;
      joint.parent_link = i;
      joint.child_link = i + 1;
      parts.joints.push_back(joint);
    }
    const auto robot = make_robot(parts);
    REQUIRE(robot.has_value());
    const auto tables = require_tables(*robot);
    CHECK(tables.frames.size() == 2);
    REQUIRE(tables.links.size() == 1);
    CHECK(tables.links[0].link == 2);
    CHECK(tables.fixed_links.empty());
  }

  TEST_CASE("a robot with more joints than the kernels hold is refused, one with as many is not") {
    const auto most = long_chain(internal::kMaxRows, 100);
    REQUIRE(most.has_value());
    CHECK(internal::make_robot_tables(*most).has_value());
    const auto more = long_chain(internal::kMaxRows + 1, 0);
    REQUIRE(more.has_value());
    const auto tables = internal::make_robot_tables(*more);
    REQUIRE(!tables.has_value());
    CHECK(tables.error().code == ErrorCode::unsupported);
    CHECK(tables.error().message.find("'snake'") != std::string::npos);
    CHECK(tables.error().message.find("64") != std::string::npos);
  }

  TEST_CASE("a robot as large as the kernels hold is checked to its last link") {
    const auto robot = long_chain(internal::kMaxRows, 0);
    REQUIRE(robot.has_value());
    const Configuration straight(internal::kMaxRows, 0.0);
    const Scene scene = make_circle_scene("s", {{0.1 * internal::kMaxRows, 0, 0.05}});
    for (const Isa isa : available_isas()) {
      CHECK(!require_checker(*robot, scene, {.isa = isa}).is_valid(straight));
      CHECK(require_checker(*robot, {}, {.isa = isa}).is_valid(straight));
    }
  }

  TEST_CASE("obstacles become rows of their kind, composite ones several") {
    const Transform X{rotation_about(Vec3::UnitZ(), kPi / 2), {1, 2, 3}};
    const Scene scene{"s",
                      {{"a", {Sphere{{1, 2, 3}, 0.5}, Box{X, {1, 2, 4}}}},
                       {"b", {Capsule{{0, 0, 0}, {1, 1, 1}, 0.25}, Sphere{{0, 0, 0}, 2}}}}};
    const auto tables = internal::make_scene_tables(scene);
    REQUIRE(tables.has_value());
    REQUIRE(tables->spheres.size() == 2);
    CHECK(vector_of(tables->spheres[0].center) == Vec3(1, 2, 3));
    CHECK(tables->spheres[0].radius == 0.5f);
    CHECK(tables->spheres[1].radius == 2.0f);
    REQUIRE(tables->capsules.size() == 1);
    CHECK(vector_of(tables->capsules[0].b) == Vec3(1, 1, 1));
    CHECK(tables->capsules[0].radius == 0.25f);
    REQUIRE(tables->boxes.size() == 1);
    CHECK(vector_of(tables->boxes[0].half_extents) == Vec3(1, 2, 4));
    CHECK(matrix_of(tables->boxes[0].rotation).isApprox(X.rotation.transpose(), 1e-6));
    CHECK(tables->boxes[0].bounding_radius >= std::sqrt(21.0));
  }

  TEST_CASE("an obstacle without shapes is an error that names it") {
    const auto tables = internal::make_scene_tables({"s", {{"ghost", {}}}});
    REQUIRE(!tables.has_value());
    CHECK(tables.error().message.find("'ghost'") != std::string::npos);
  }
}

TEST_SUITE("law") {
  TEST_CASE("the tables put every shape where the robot's own kinematics do") {
    Rng rng(501);
    for (int i = 0; i < 200; ++i) {
      const Robot robot = random_robot(rng);
      const auto tables = require_tables(robot);
      const Configuration q = random_configuration(robot, rng);
      const auto frames = frame_poses(tables, q);
      const auto poses = robot.link_poses(q);
      INFO("seed 501, robot " << i);
      auto rows = tables.links;
      rows.insert(rows.end(), tables.fixed_links.begin(), tables.fixed_links.end());
      std::set<int> seen;
      for (const internal::LinkRow& row : rows) {
        const Link& link = robot.links()[static_cast<std::size_t>(row.link)];
        const Transform X_WF = pose_of(row, frames),
                        X_WL = poses[static_cast<std::size_t>(row.link)];
        REQUIRE(seen.insert(row.link).second);
        REQUIRE(row.sphere_end - row.sphere_begin == std::ssize(link.spheres));
        REQUIRE(row.capsule_end - row.capsule_begin == std::ssize(link.capsules));
        for (std::size_t k = 0; k < link.spheres.size(); ++k) {
          const auto& own = tables.spheres.at(static_cast<std::size_t>(row.sphere_begin) + k);
          REQUIRE((X_WF * vector_of(own.center) - X_WL * link.spheres[k].center).norm() < 1e-5);
          REQUIRE(own.radius == static_cast<float>(link.spheres[k].radius));
        }
        for (std::size_t k = 0; k < link.capsules.size(); ++k) {
          const auto& own = tables.capsules.at(static_cast<std::size_t>(row.capsule_begin) + k);
          REQUIRE((X_WF * vector_of(own.a) - X_WL * link.capsules[k].a).norm() < 1e-5);
          REQUIRE((X_WF * vector_of(own.b) - X_WL * link.capsules[k].b).norm() < 1e-5);
          REQUIRE(own.radius == static_cast<float>(link.capsules[k].radius));
        }
      }
      for (std::size_t k = 0; k < robot.links().size(); ++k) {
        const Link& link = robot.links()[k];
        const bool has_shapes = !link.spheres.empty() || !link.capsules.empty();
        REQUIRE(seen.contains(static_cast<int>(k)) == has_shapes);
      }
    }
  }

  TEST_CASE("bounding spheres contain all shapes of their link, closely if there is only one") {
    Rng rng(502);
    for (int i = 0; i < 200; ++i) {
      const Robot robot = random_robot(rng);
      const auto tables = require_tables(robot);
      for (const internal::LinkRow& row : tables.links) {
        const Vec3 center = vector_of(row.center);
        double reach = 0;
        for (int k = row.sphere_begin; k < row.sphere_end; ++k) {
          const auto& own = tables.spheres[static_cast<std::size_t>(k)];
          reach = std::max(reach, (vector_of(own.center) - center).norm() + own.radius);
        }
        for (int k = row.capsule_begin; k < row.capsule_end; ++k) {
          const auto& own = tables.capsules[static_cast<std::size_t>(k)];
          reach = std::max({reach, (vector_of(own.a) - center).norm() + own.radius,
                            (vector_of(own.b) - center).norm() + own.radius});
        }
        REQUIRE(row.radius >= reach);
        REQUIRE(row.radius < reach + 1e-5);
      }
    }
  }

  TEST_CASE("the tables hold exactly the pairs that the robot names") {
    Rng rng(503);
    for (int i = 0; i < 200; ++i) {
      const Robot robot = random_robot(rng);
      const auto tables = require_tables(robot);
      std::multiset<std::pair<int, int>> pairs;
      const auto add = [&](int a, int b) { pairs.insert(std::minmax(a, b)); };
      for (const auto& [a, b] : tables.pairs) {
        add(tables.links.at(static_cast<std::size_t>(a)).link,
            tables.links.at(static_cast<std::size_t>(b)).link);
      }
      for (const auto& [a, b] : tables.fixed_pairs) {
        add(tables.links.at(static_cast<std::size_t>(a)).link,
            tables.fixed_links.at(static_cast<std::size_t>(b)).link);
      }
      REQUIRE(pairs == std::multiset<std::pair<int, int>>(robot.self_pairs().begin(),
                                                          robot.self_pairs().end()));
    }
  }
}

}  // namespace
}  // namespace mneme::test
