// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/memory.h"

#include "memory/moved_means.h"
#include "memory/near_pairs.h"
#include "robot/kinematics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <optional>

namespace mneme {
namespace internal {
namespace {

// Robot files give angles to about 1e-9 and lengths to a micrometre; larger deviations are
// intended.
constexpr double kTolerance = 1e-6;

bool is_on_x_axis(const Link& link) {
  const auto is_off = [](const Vec3& point) { return std::abs(point.y()) > kTolerance; };
  return std::none_of(link.spheres.begin(), link.spheres.end(),
                      [&](const Sphere& sphere) { return is_off(sphere.center); }) &&
         std::none_of(link.capsules.begin(), link.capsules.end(), [&](const Capsule& capsule) {
           return is_off(capsule.a) || is_off(capsule.b);
         });
}

/// True if joint 1 turns the whole body of the link about the base's z axis.
bool is_turned(const Transform& before, const Transform& after, double angle) {
  const Transform turn{rotation_about(Vec3::UnitZ(), angle), Vec3::Zero()};
  const Transform expected = turn * before;
  return (expected.rotation - after.rotation).norm() < kTolerance &&
         (expected.translation - after.translation).norm() < kTolerance;
}

/// Reason why rotations and mirror images are not symmetries of `robot`, or nothing.
std::optional<std::string> describe_asymmetry(const Robot& robot) {
  if (!robot.is_planar() || robot.joint_count() == 0) {
    return "the robot is not planar: all its joints must turn about the z axis";
  }
  Configuration q(static_cast<std::size_t>(robot.joint_count()), 0.0);
  const std::vector<Transform> straight = robot.link_poses(q);
  q[0] = 1.0;
  const std::vector<Transform> turned = robot.link_poses(q);
  for (std::size_t i = 0; i < straight.size(); ++i) {
    const Link& link = robot.links()[i];
    if (!has_shapes(link)) continue;
    if (!is_turned(straight[i], turned[i], 1.0)) {
      return fmt::format("joint '{}' does not turn link '{}' about the base",
                         robot.group_joint(0).name, link.name);
    }
    if (std::abs(straight[i].translation.y()) > kTolerance ||
        std::abs(straight[i].rotation(1, 0)) > kTolerance || !is_on_x_axis(link)) {
      return fmt::format("link '{}' is not its own mirror image when all joints are 0", link.name);
    }
  }
  return std::nullopt;
}

double shape_extent(const Link& link) {
  double extent = 0;
  for (const Sphere& sphere : link.spheres) {
    extent = std::max(extent, sphere.center.head<2>().norm() + sphere.radius);
  }
  for (const Capsule& capsule : link.capsules) {
    const double end = std::max(capsule.a.head<2>().norm(), capsule.b.head<2>().norm());
    extent = std::max(extent, end + capsule.radius);
  }
  return extent;
}

/// Largest distance of any point of the robot from the base, ignoring joint limits.
double reach(const Robot& robot) {
  std::vector<double> extents(robot.links().size(), 0.0);
  double result = 0;
  for (std::size_t i = 0; i < extents.size(); ++i) {
    const Link& link = robot.links()[i];
    if (link.parent_joint >= 0) {
      const Joint& joint = robot.joints()[static_cast<std::size_t>(link.parent_joint)];
      extents[i] = extents[static_cast<std::size_t>(joint.parent_link)] +
                   joint.origin.translation.head<2>().norm();
    }
    if (has_shapes(link)) result = std::max(result, extents[i] + shape_extent(link));
  }
  return result;
}

using Circle = std::array<double, 3>;  // x, y, radius

Result<Circle> as_circle(const Obstacle& obstacle) {
  const auto refuse = [&](ErrorCode code, const std::string& what) {
    return fail(code, fmt::format("obstacle '{}' {}; memory of the kind 'pairs' expects one sphere "
                                  "centred in the plane z = 0",
                                  obstacle.name, what));
  };
  if (obstacle.shapes.size() != 1) {
    return refuse(ErrorCode::unsupported, fmt::format("has {} shapes", obstacle.shapes.size()));
  }
  const auto* sphere = std::get_if<Sphere>(&obstacle.shapes[0]);
  if (sphere == nullptr) {
    return refuse(ErrorCode::unsupported, fmt::format("is a {}", shape_name(obstacle.shapes[0])));
  }
  if (!sphere->center.allFinite() || !std::isfinite(sphere->radius) || sphere->radius <= 0) {
    return refuse(ErrorCode::invalid, "has a centre or radius that is no length");
  }
  if (std::abs(sphere->center.z()) > kTolerance) {
    return refuse(ErrorCode::unsupported, fmt::format("is centred at z = {}", sphere->center.z()));
  }
  return Circle{sphere->center.x(), sphere->center.y(), sphere->radius};
}

/// Distance from the base to the segment that joins the two circles' surfaces.
double gap_distance(const Circle& a, const Circle& b) {
  const Vec3 center_a(a[0], a[1], 0);
  const Vec3 center_b(b[0], b[1], 0);
  const Vec3 direction = (center_b - center_a).normalized();
  const Vec3 from = center_a + a[2] * direction;
  const Vec3 to = center_b - b[2] * direction;
  const double along = std::clamp(-from.dot(direction), 0.0, (to - from).norm());
  return (from + along * direction).norm();
}

std::vector<KeyImage> images_of_circles(const PrimitiveKey& k) {
  assert(k.size() == kCirclePairKeySize);
  return {{k, false},
          {{k[3], k[4], k[5], k[0], k[1], k[2]}, false},
          {{k[0], -k[1], k[2], k[3], -k[4], k[5]}, true},
          {{k[3], -k[4], k[5], k[0], -k[1], k[2]}, true}};
}

Result<std::vector<LocalPrimitive>> decompose_into_circle_pairs(const MemoryQuery& query,
                                                                double max_gap) {
  const Robot& robot = query.robot;
  const Scene& scene = query.scene;
  if (const auto reason = describe_asymmetry(robot)) {
    return fail(ErrorCode::unsupported,
                fmt::format("memory of the kind 'pairs' does not handle robot '{}': {}",
                            robot.name(), *reason));
  }
  std::vector<Circle> circles;
  for (const Obstacle& obstacle : scene.obstacles) {
    const Circle circle = MNEME_TRY(as_circle(obstacle));
    circles.push_back(circle);
  }
  const auto pairs = MNEME_TRY(find_near_pairs(scene, max_gap));
  const double farthest = reach(robot);
  std::vector<LocalPrimitive> primitives;
  for (const auto& [i, j] : pairs) {
    const Circle& a = circles[static_cast<std::size_t>(i)];
    const Circle& b = circles[static_cast<std::size_t>(j)];
    const double gap = std::hypot(b[0] - a[0], b[1] - a[1]) - a[2] - b[2];
    if (gap <= 0 || gap > max_gap || gap_distance(a, b) > farthest) continue;
    primitives.push_back(make_primitive({a[0], a[1], a[2], b[0], b[1], b[2]}));
    primitives.back().obstacles = {i, j};
  }
  return primitives;
}

}  // namespace

extern constinit const MemoryKind kCirclePairs = {
    .name = "pairs",
    .version = "pairs/1",
    .summary = "two circles and the gap between them, as in the paper; for planar arms",
    .defaults = {.share = {.lambda = 0.8, .least_lambda = 0.2},
                 .share_with_walks =
                     MemoryShare{.lambda = 0.5, .least_lambda = 0.02, .retrieve_after = 1000},
                 .sigma = 0.03,
                 .similarity = 2,
                 .retarget = true,
                 .max_gap = 1},
    .handles = [](const Robot& robot) { return robot.is_planar(); },
    .rank_for_scenes = 2,
    .rank_for_paths = 2,
    .key_size = [](const Robot&) { return static_cast<int>(kCirclePairKeySize); },
    .decompose = decompose_into_circle_pairs,
    .images = images_of_circles,
    .synthesize = pool_moved_means,
    .retarget = retarget_means,
    .learn_from_paths = learn_waypoints<decompose_into_circle_pairs>,
    .learn = learn_local_sampler,
};

}  // namespace internal

LocalPrimitive make_primitive(const PrimitiveKey& circles) {
  assert(circles.size() == kCirclePairKeySize);
  LocalPrimitive primitive;
  primitive.kind = internal::kCirclePairs.version;
  primitive.obstacles = {0, 1};
  const double x = circles[0] + circles[3];
  const double y = circles[1] + circles[4];
  primitive.to_scene.rotation = std::atan2(y, x);
  primitive.key = moved_key(Symmetry{-primitive.to_scene.rotation, false}, circles);
  primitive.gap =
      std::hypot(circles[3] - circles[0], circles[4] - circles[1]) - circles[2] - circles[5];
  return primitive;
}

Scene make_scene(const PrimitiveKey& key) {
  assert(key.size() == kCirclePairKeySize);
  const Sphere a{Vec3(key[0], key[1], 0), key[2]};
  const Sphere b{Vec3(key[3], key[4], 0), key[5]};
  return Scene{"primitive", {Obstacle{"circle_a", {a}}, Obstacle{"circle_b", {b}}}};
}

}  // namespace mneme
