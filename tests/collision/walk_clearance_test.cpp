// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/collision.h"

#include "collision/clearance.h"
#include "tables/make_tables.h"
#include "collision/walking_robots.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace mneme::test {
namespace {

/// A point of an obstacle's surface in the obstacle's frame, and the normal there.
struct SurfacePoint {
  Vec3 point, normal;
};

/// An obstacle around the origin, and where it is touched.
struct Touched {
  Shape shape;
  SurfacePoint surface;
};

enum TouchedKind { kSphere, kAlignedBox, kBox, kUprightCylinder, kCylinder, kCapsule };
constexpr std::array kTouchedNames = {"sphere",           "aligned box",     "rotated box",
                                      "upright cylinder", "tilted cylinder", "capsule"};
constexpr std::array kTouchedKinds = {kSphere,          kAlignedBox, kBox,
                                      kUprightCylinder, kCylinder,   kCapsule};

bool is_aligned(TouchedKind kind) { return kind == kAlignedBox || kind == kUprightCylinder; }

Vec3 random_horizontal(Rng& rng) {
  const double angle = rng.uniform(-kPi, kPi);
  return {std::cos(angle), std::sin(angle), 0};
}
Vec3 up_or_down(Rng& rng) { return rng.index(2) == 0 ? Vec3::UnitZ() : Vec3(-Vec3::UnitZ()); }

/// At a face, not near its edges.
Touched touched_box(bool is_on_top, Rng& rng) {
  const Vec3 half = random_vector(rng, 0.1).cwiseAbs() + Vec3::Constant(0.08);
  const std::uint32_t axis = is_on_top ? 2 : rng.index(3);
  Vec3 normal = Vec3::Zero();
  normal[axis] = up_or_down(rng).z();
  Vec3 point = random_vector(rng, 0.04);
  point[axis] = normal[axis] * half[axis];
  return {Box{{}, half}, {point, normal}};
}

/// At the side or, unless `is_beside`, now and then at an end.
Touched touched_cylinder(bool is_beside, Rng& rng) {
  const double radius = rng.uniform(0.08, 0.15), half_length = rng.uniform(0.1, 0.2);
  const Vec3 around = random_horizontal(rng), up = up_or_down(rng);
  const Shape shape = Cylinder{{}, radius, 2 * half_length};
  if (!is_beside && rng.index(2) == 0) return {shape, {half_length * up + 0.02 * around, up}};
  const double height = is_beside ? 0 : rng.uniform(-0.02, 0.02);
  return {shape, {radius * around + height * up, around}};
}

/// By a ball or, if `is_beside`, by something long, which meets round shapes at half their height.
Touched touched_shape(TouchedKind kind, bool is_beside, Rng& rng) {
  const double radius = rng.uniform(0.08, 0.15);
  const Vec3 around = random_horizontal(rng);
  switch (kind) {
    case kSphere:
      return {Sphere{Vec3::Zero(), radius}, {radius * around, around}};
    case kAlignedBox:
    case kBox:
      return touched_box(kind == kAlignedBox && is_beside, rng);
    case kUprightCylinder:
    case kCylinder:
      return touched_cylinder(is_beside, rng);
    case kCapsule:
      break;
  }
  const double height = is_beside ? 0 : rng.uniform(-0.1, 0.1);
  return {Capsule{Vec3(0, 0, -0.15), Vec3(0, 0, 0.15), radius},
          {radius * around + height * Vec3::UnitZ(), around}};
}

/// A rotation with the columns `x`, `y` and what is square to both.
Eigen::Matrix3d frame_of(const Vec3& x, const Vec3& y) {
  Eigen::Matrix3d frame;
  frame << x, y, x.cross(y);
  return frame;
}

/// How an obstacle must turn for its normal to be square to `along`, where something long touches
/// it, and so for the axis of a capsule.
Eigen::Matrix3d turn_beside(TouchedKind kind, const Vec3& normal, const Vec3& along, Rng& rng) {
  if (kind == kAlignedBox) return Eigen::Matrix3d::Identity();
  const Vec3 up = std::abs(normal.z()) > 0.9 ? Vec3::UnitX() : Vec3::UnitZ();
  Vec3 aside = along.cross(Vec3::UnitZ()).normalized();
  if (!is_aligned(kind)) aside = rotation_about(along, rng.uniform(-kPi, kPi)) * aside;
  Vec3 across = along.cross(aside);
  const bool spins = kind == kBox || kind == kCylinder;
  if (spins) across = rotation_about(aside, rng.uniform(-kPi, kPi)) * across;
  return frame_of(aside, across) * frame_of(normal, up).transpose();
}

/// An obstacle whose surface is `distance` from `center`, which is inside if that is negative.
Shape placed(const Touched& touched, const Eigen::Matrix3d& turn, const Vec3& center,
             double distance) {
  const Vec3 surface = turn * touched.surface.point;
  const Vec3 normal = turn * touched.surface.normal;
  return transformed({turn, center - distance * normal - surface}, touched.shape);
}

/// A hand on slides at a random place, with an obstacle at the ball or capsule of its first link.
struct Situation {
  Configuration q;
  Scene scene;
};

/// Least distance of the links except link 4, which is at the obstacle.
double clearance_of_others(const Robot& robot, const Situation& s) {
  const std::vector<Transform> poses = robot.link_poses(s.q);
  double least = 1e9;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (i == 4) continue;
    least =
        std::min(least, gap_between(capsules_of(robot.links()[i], poses[i]), s.scene.obstacles[0]));
  }
  return least;
}

/// Least distance of all links from the obstacles.
double scene_clearance(const Robot& robot, const Scene& scene, std::span<const float> q) {
  const std::vector<Transform> poses = robot.link_poses(to_configuration(q));
  double least = 1e9;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (const Obstacle& obstacle : scene.obstacles) {
      least = std::min(least, gap_between(capsules_of(robot.links()[i], poses[i]), obstacle));
    }
  }
  return least;
}

constexpr double kRadius = 0.05;
constexpr float kClearance = 0.02f;

/// The surfaces of link 4 and the obstacle are `gap` apart; negative: they overlap.
Situation make_situation(const Robot& robot, bool is_capsule, TouchedKind kind, double gap,
                         Rng& rng) {
  Situation s;
  do {
    s.q = {rng.uniform(-1, 1),
           rng.uniform(-1, 1),
           rng.uniform(-1, 1),
           rng.uniform(-1.5, 1.5),
           (rng.index(2) == 0 ? 1 : -1) * rng.uniform(0.8, 1.5),
           0};
    const Transform link = robot.link_poses(s.q)[4];
    const Vec3 center = link * Vec3(is_capsule ? rng.uniform(0.12, 0.38) : 0.25, 0, 0);
    const Touched touched = touched_shape(kind, is_capsule, rng);
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    if (is_capsule) {
      turn = turn_beside(kind, touched.surface.normal, link.rotation.col(0), rng);
    } else if (!is_aligned(kind)) {
      turn = random_pose(rng, 1).rotation;
    }
    // The other box keeps the scene's axes where they are.
    s.scene.obstacles = {{"it", {placed(touched, turn, center, gap + kRadius)}},
                         {"far", {box_at({30, 30, 30}, {0.1, 0.1, 0.1})}}};
  } while (clearance_of_others(robot, s) < 0.1);
  return s;
}

internal::ObstacleKind kind_of(const Scene& scene) {
  return require(internal::make_scene_tables(scene)).obstacles.at(0).kind;
}

/// Checks that a step takes the robot to the clearance that it asks for; false if it left the robot
/// where it was, which a test may count.
bool step_clears(const Robot& robot, const Situation& s) {
  const CollisionChecker checker = require_checker(robot, s.scene);
  OwnedStep step(robot, 1);
  step.clearance = kClearance;
  step.length = 0.01f;
  const std::vector<float> end = step.take(checker, to_row(s.q));
  double moved = 0;
  for (std::size_t j = 0; j < 5; ++j) moved = std::max(moved, std::abs(end[j] - s.q[j]));
  if (moved < 1e-4) return false;
  CHECK(std::abs(clearance(robot, s.scene, end) - kClearance) < 0.15 * kClearance);
  return true;
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("a step away from an obstacle of any kind leaves the clearance that is asked for") {
    Rng rng(21);
    int steps = 0, back = 0;
    for (const bool is_capsule : {false, true}) {
      const Robot robot = hand_and_pointer(is_capsule);
      for (const TouchedKind kind : kTouchedKinds) {
        for (int i = 0; i < rounds(60); ++i) {
          // Within the clearance, in contact, and with the centre of the ball inside.
          for (const double gap : {0.01, -0.03, -0.06}) {
            const Situation s = make_situation(robot, is_capsule, kind, gap, rng);
            INFO(std::string(is_capsule ? "capsule, " : "ball, "),
                 std::string(kTouchedNames.at(kind)), ", gap ", gap, ", round ", i);
            back += step_clears(robot, s) ? 0 : 1;
            ++steps;
          }
        }
      }
    }
    CHECK(back == 0);
  }

  TEST_CASE("what is farther away than the clearance does not count") {
    Rng rng(22);
    const Robot robot = hand_and_pointer(false);
    for (const TouchedKind kind : kTouchedKinds) {
      for (int i = 0; i < rounds(40); ++i) {
        const Situation s = make_situation(robot, false, kind, 0.025, rng);
        OwnedStep step(robot, 1);
        step.clearance = kClearance;
        const std::vector<float> end = step.take(require_checker(robot, s.scene), to_row(s.q));
        for (std::size_t j = 0; j < end.size(); ++j) {
          CHECK(std::abs(end[j] - static_cast<float>(s.q[j])) < 1e-5);
        }
      }
    }
  }

  TEST_CASE("an arm that is too close to circles comes off them while its tip is pulled") {
    const Robot robot = planar8();
    Rng rng(24);
    constexpr float kApart = 0.1f;
    int starts = 0, better = 0, better_unasked = 0;
    while (starts < rounds(200)) {
      const Scene scene = random_circles(12, rng);
      const std::vector<float> from = random_states(robot, 1, rng);
      const double before = scene_clearance(robot, scene, from);
      if (before <= 0 || before > 0.5 * kApart) continue;
      ++starts;
      const CollisionChecker checker = require_checker(robot, scene);
      OwnedStep step(robot, 1);
      step.length = 0.1f;
      better_unasked += scene_clearance(robot, scene, step.take(checker, from)) > before ? 1 : 0;
      step.clearance = kApart;
      better += scene_clearance(robot, scene, step.take(checker, from)) > before ? 1 : 0;
    }
    INFO(better, " of ", starts, " with, ", better_unasked, " without clearance");
    CHECK(better >= 0.9 * starts);
    CHECK(better_unasked < 0.7 * starts);
  }

  TEST_CASE("a ball on the diagonal of a box, where two faces are closest, is pushed off it") {
    Rng rng(25);
    const Robot robot = hand_and_pointer(false);
    int back = 0;
    for (int i = 0; i < 20; ++i) {
      Situation s{Configuration(6, 0.0), {}};
      // The ball of the first link is at x = 1/4; as deep below both faces, or nearly.
      const double off = i == 0 ? 0 : rng.uniform(-0.002, 0.002);
      s.scene.obstacles = {
          {"it", {box_at({0.25 - 0.25 + 0.015625, off - 0.25 + 0.015625, 0}, {0.25, 0.25, 0.3})}}};
      back += step_clears(robot, s) ? 0 : 1;
    }
    CHECK(back < 3);
  }

  TEST_CASE("the situations of these tests have obstacles of the kinds they are named for") {
    Rng rng(23);
    using internal::ObstacleKind;
    const std::array kinds = {ObstacleKind::sphere,   ObstacleKind::aligned_box,
                              ObstacleKind::box,      ObstacleKind::upright_cylinder,
                              ObstacleKind::cylinder, ObstacleKind::capsule};
    for (const TouchedKind kind : kTouchedKinds) {
      for (const bool is_capsule : {false, true}) {
        const Robot robot = hand_and_pointer(is_capsule);
        for (const double gap : {0.01, -0.03, -0.06}) {
          const Situation s = make_situation(robot, is_capsule, kind, gap, rng);
          CHECK(kind_of(s.scene) == kinds.at(kind));
          // Distances from solids are 0 inside.
          CHECK(clearance(robot, s.scene, s.q) == doctest::Approx(std::max(gap, -kRadius)));
        }
      }
    }
  }
}

}  // namespace mneme::test
