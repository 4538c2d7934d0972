// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Random points, meshes and octrees, and distances from them part by part.
#pragma once

#include "geometry/part_distance.h"
#include "geometry/random_shapes.h"

#include <algorithm>
#include <memory>
#include <vector>

namespace mneme::test {

template <class Part>
CompoundShape<Part> compound_of(std::vector<Part> parts, double radius = 0) {
  return {{}, std::make_shared<Parts<Part>>(std::move(parts)), radius};
}

/// Points on a few patches, as sensors see them, and some that lie about.
inline Shape random_cloud(Rng& rng) {
  std::vector<CloudPoint> points;
  for (int patch = 0; patch < 3; ++patch) {
    const Transform pose = random_pose(rng, 0.4);
    for (int i = 0; i < 300; ++i) {
      const Vec3 p =
          pose * Vec3{rng.uniform(-0.3, 0.3), rng.uniform(-0.3, 0.3), rng.uniform(-0.002, 0.002)};
      const Eigen::Vector3f f = p.cast<float>();
      points.push_back({f.x(), f.y(), f.z()});
    }
  }
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3f f = random_vector(rng, 1.0).cast<float>();
    points.push_back({f.x(), f.y(), f.z()});
  }
  return compound_of(std::move(points), rng.uniform(0.001, 0.03));
}

/// Triangles of all sizes, slivers among them.
inline Shape random_mesh(Rng& rng) {
  std::vector<Triangle> triangles;
  for (int i = 0; i < 60; ++i) {
    const Vec3 at = random_vector(rng, 0.5);
    const double size = i < 3 ? 0.6 : rng.uniform(0.005, 0.1);
    Triangle t{at, at + random_vector(rng, size), at + random_vector(rng, size)};
    if (i % 10 == 9) t.c = t.a + 0.5 * (t.b - t.a) + random_vector(rng, 1e-4);
    triangles.push_back(t);
  }
  return compound_of(std::move(triangles), rng.index(2) == 0 ? 0.0 : 0.01);
}

inline Shape random_octree(Rng& rng) {
  std::vector<Cube> cubes;
  for (int i = 0; i < 200; ++i) {
    const double edge = 0.025 * static_cast<double>(1u << rng.index(3));
    const Vec3 cell = (random_vector(rng, 0.5) / edge).array().round();
    cubes.push_back({edge * cell, 0.5 * edge});
  }
  return compound_of(std::move(cubes));
}

inline std::vector<Vec3> corners_of(const CloudPoint& p) { return {Vec3(p[0], p[1], p[2])}; }
inline std::vector<Vec3> corners_of(const Triangle& t) { return {t.a, t.b, t.c}; }
inline std::vector<Vec3> corners_of(const Cube& cube) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) {
    const Vec3 sign((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
    corners.emplace_back(cube.center + cube.half_extent * sign);
  }
  return corners;
}

/// Neighbouring parts, and a ball around all of them: halves of them, or few.
template <class Part>
struct BallOfParts {
  Vec3 center;
  double radius = 0;
  std::vector<BallOfParts> halves = {};
  std::vector<Part> parts = {};
};

/// By halves along the longest axis, down to four parts.
template <class Part>
BallOfParts<Part> ball_of_parts(std::vector<Part> parts) {
  Vec3 low = corners_of(parts.front()).front(), high = low;
  for (const Part& part : parts) {
    for (const Vec3& corner : corners_of(part)) {
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
  }
  BallOfParts<Part> ball{0.5 * (low + high)};
  for (const Part& part : parts) {
    for (const Vec3& corner : corners_of(part)) {
      ball.radius = std::max(ball.radius, (corner - ball.center).norm() + 1e-9);
    }
  }
  if (parts.size() <= 4) {
    ball.parts = std::move(parts);
    return ball;
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const auto half = parts.begin() + std::ssize(parts) / 2;
  std::nth_element(parts.begin(), half, parts.end(), [&](const Part& p, const Part& q) {
    return corners_of(p).front()[axis] < corners_of(q).front()[axis];
  });
  ball.halves.push_back(ball_of_parts(std::vector<Part>(parts.begin(), half)));
  ball.halves.push_back(ball_of_parts(std::vector<Part>(half, parts.end())));
  return ball;
}

/// The least distance from any part, one after the other: 0 in contact.
struct DistanceByParts {
  Vec3 a, b;
  template <class Solid>
  double operator()(const Solid&) const {
    return -1;
  }
  template <class Part>
  double operator()(const CompoundShape<Part>& compound) const {
    const Transform to_parts = compound.pose.inverse();
    const Vec3 from = to_parts * a, to = to_parts * b;
    double least = std::numeric_limits<double>::infinity();
    for (const Part& part : compound.parts->list()) {
      least = std::min(least, internal::distance_between(from, to, part));
    }
    return std::max(0.0, least - compound.radius);
  }
};

}  // namespace mneme::test
