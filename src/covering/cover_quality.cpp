// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "covering/cover_quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "mneme/base.h"

namespace mneme::internal {
namespace {

constexpr int kPointsPerSphere = 400;
/// Rounding must not make a point on the skin of a sphere that just reaches it bare.
constexpr double kTolerance = 1e-9;

bool is_covered(const Vec3& point, std::span<const Sphere> spheres) {
  return std::ranges::any_of(spheres, [&](const Sphere& sphere) {
    return (point - sphere.center).norm() <= sphere.radius + kTolerance;
  });
}

/// Points that are spread evenly over the unit sphere along a spiral.
Vec3 spiral_point(int index, int count) {
  const double golden_angle = std::numbers::pi * (3 - std::sqrt(5.0));
  const double z = 1 - (2 * index + 1.0) / count;
  const double radius = std::sqrt(1 - z * z);
  return {radius * std::cos(golden_angle * index), radius * std::sin(golden_angle * index), z};
}

}  // namespace

std::vector<Vec3> sample_surface(const TriangleMesh& mesh, int count) {
  std::vector<double> sums;
  double area = 0;
  for (const Triangle& triangle : mesh) sums.push_back(area += triangle.area());
  Rng rng(1);
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const auto found = std::ranges::upper_bound(sums, area * rng.uniform());
    const Triangle& t =
        mesh[std::min(static_cast<std::size_t>(found - sums.begin()), mesh.size() - 1)];
    const double root = std::sqrt(rng.uniform());
    const double u = rng.uniform();
    points.push_back((1 - root) * t.a + root * (1 - u) * t.b + root * u * t.c);
  }
  return points;
}

std::vector<Vec3> sample_near_surface(const SolidModel& solid) {
  const std::array<Vec3, 4> corners = {Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1),
                                       Vec3(-1, -1, 1)};
  std::vector<Vec3> points;
  for (const SolidModel::Cell& cell : solid.inner_cells()) {
    if (cell.is_whole) continue;
    for (const Vec3& corner : corners) {
      const Vec3 point = cell.center + 0.25 * solid.cell_size() * corner;
      if (solid.contains(point)) points.push_back(point);
    }
  }
  return points;
}

double uncovered_fraction(std::span<const Vec3> points, std::span<const Sphere> spheres) {
  if (points.empty()) return 0;
  const auto bare =
      std::ranges::count_if(points, [&](const Vec3& p) { return !is_covered(p, spheres); });
  return static_cast<double>(bare) / static_cast<double>(points.size());
}

Excess measure_excess(std::span<const Sphere> spheres, const SolidModel& solid) {
  Excess excess;
  double area = 0;
  for (std::size_t s = 0; s < spheres.size(); ++s) {
    const double share = spheres[s].radius * spheres[s].radius;
    for (int i = 0; i < kPointsPerSphere; ++i) {
      const Vec3 point = spheres[s].center + spheres[s].radius * spiral_point(i, kPointsPerSphere);
      const bool is_hidden =
          is_covered(point, spheres.first(s)) || is_covered(point, spheres.subspan(s + 1));
      if (is_hidden) continue;
      const double outside = std::max(0.0, -solid.depth(point));
      area += share;
      excess.mean += share * outside;
      excess.max = std::max(excess.max, outside);
    }
  }
  if (area > 0) excess.mean /= area;
  return excess;
}

}  // namespace mneme::internal
