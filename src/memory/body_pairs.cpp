// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/memory.h"

#include "geometry/solids.h"
#include "memory/moved_means.h"
#include "memory/near_pairs.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace mneme {
namespace {

constexpr std::string_view kBodyPairsVersion = "body_pairs/1";

internal::Moments moments_of(const Obstacle& obstacle) {
  internal::Moments sum;
  for (const Shape& shape : obstacle.shapes) {
    const internal::Moments part = internal::moments_of(shape);
    sum.volume += part.volume;
    sum.centroid += part.volume * part.centroid;
    sum.covariance += part.volume * (part.covariance + part.centroid * part.centroid.transpose());
  }
  if (sum.volume <= 0) return sum;
  sum.centroid /= sum.volume;
  sum.covariance = sum.covariance / sum.volume - sum.centroid * sum.centroid.transpose();
  return sum;
}

Eigen::Matrix3d square_root(const Eigen::Matrix3d& m) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(m);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         solver.eigenvectors().transpose();
}

/// Centroid of an obstacle, and S of kBodyKeySize.
struct Body {
  Vec3 centroid;
  Eigen::Matrix3d spread;
};

Body make_body(const Obstacle& obstacle) {
  const internal::Moments of_all = moments_of(obstacle);
  return {of_all.centroid, square_root(3 * of_all.covariance)};
}

void write(const Body& body, double* key) {
  const Eigen::Matrix3d& s = body.spread;
  constexpr double kTwice = std::numbers::sqrt2;
  const std::array<double, kBodyKeySize> values = {
      body.centroid.x(), body.centroid.y(), body.centroid.z(), s(0, 0),         s(1, 1),
      s(2, 2),           kTwice * s(0, 1),  kTwice * s(0, 2),  kTwice * s(1, 2)};
  std::copy(values.begin(), values.end(), key);
}

LocalPrimitive make_primitive_of(const SymmetricJoints& joints, const Body& a, const Body& b) {
  const Vec3 axis(joints.axis_x, joints.axis_y, 0);
  const Vec3 middle = 0.5 * (a.centroid + b.centroid) - axis;
  LocalPrimitive primitive;
  primitive.obstacles = {0, 1};
  primitive.kind = kBodyPairsVersion;
  if (joints.turn >= 0) primitive.to_scene.rotation = std::atan2(middle.y(), middle.x());
  if (joints.lift >= 0) primitive.to_scene.lift = middle.z();
  const Eigen::Matrix3d turn = rotation_about(Vec3::UnitZ(), -primitive.to_scene.rotation);
  const auto canonical = [&](const Body& body) {
    const Vec3 shift(0, 0, primitive.to_scene.lift);
    return Body{turn * (body.centroid - axis - shift), turn * body.spread * turn.transpose()};
  };
  primitive.key.resize(2 * kBodyKeySize);
  write(canonical(a), primitive.key.data());
  write(canonical(b), primitive.key.data() + kBodyKeySize);
  return primitive;
}

}  // namespace

LocalPrimitive make_body_primitive(const SymmetricJoints& joints, const Obstacle& a,
                                   const Obstacle& b) {
  LocalPrimitive primitive = make_primitive_of(joints, make_body(a), make_body(b));
  primitive.gap = internal::obstacle_distance(a, b, std::numeric_limits<double>::infinity());
  return primitive;
}

namespace internal {
namespace {

Result<std::vector<LocalPrimitive>> decompose_into_body_pairs(const MemoryQuery& query,
                                                              double max_gap) {
  const Robot& robot = query.robot;
  const std::optional<Scene> boxed = with_boxed_compounds(query.scene);
  const Scene& scene = boxed ? *boxed : query.scene;
  const SymmetricJoints joints = find_symmetric_joints(robot);
  const auto pairs = MNEME_TRY(find_near_pairs(scene, max_gap));
  std::vector<LocalPrimitive> primitives;
  if (pairs.empty()) return primitives;
  std::vector<Body> bodies;
  for (const Obstacle& obstacle : scene.obstacles) bodies.push_back(make_body(obstacle));
  for (const auto& [first, second] : pairs) {
    const auto i = static_cast<std::size_t>(first);
    const auto j = static_cast<std::size_t>(second);
    const double gap = obstacle_distance(scene.obstacles[i], scene.obstacles[j], max_gap);
    if (gap > max_gap) continue;
    primitives.push_back(make_primitive_of(joints, bodies[i], bodies[j]));
    primitives.back().obstacles = {first, second};
    primitives.back().gap = gap;
  }
  return primitives;
}

std::vector<KeyImage> images_of_bodies(const PrimitiveKey& canonical) {
  PrimitiveKey swapped = canonical;
  std::rotate(swapped.begin(), swapped.begin() + kBodyKeySize, swapped.end());
  return {{canonical, false}, {std::move(swapped), false}};
}

}  // namespace

extern constinit const MemoryKind kBodyPairs = {
    .name = "body_pairs",
    .version = kBodyPairsVersion,
    .summary = "two near obstacles of any shapes, by centroid and extent; for arms in space",
    // Samples around a mean just inside an obstacle lie at its surface, where they are useful.
    .defaults = {.share = {.retrieve_after = 1500},
                 .sigma = 0.3,
                 .similarity = 0.05,
                 .drop_invalid_means = false,
                 .first_components = 20,
                 .max_gap = 0.25},
    .handles = [](const Robot&) { return true; },
    .rank_for_scenes = 1,
    .key_size = [](const Robot&) { return 2 * kBodyKeySize; },
    .decompose = decompose_into_body_pairs,
    .images = images_of_bodies,
    .synthesize = pool_moved_means,
    .learn_from_paths = learn_waypoints<decompose_into_body_pairs>,
};

}  // namespace internal
}  // namespace mneme
