// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "spheres/approximate_solid.h"

#include "mneme/base.h"
#include "mneme/spheres.h"

#include "base/check_ranges.h"
#include "geometry/axis_box.h"
#include "geometry/part_distance.h"
#include "spheres/fit_capsule.h"
#include "spheres/sphere_search.h"
#include "spheres/solid_model.h"
#include "spheres/triangle_mesh.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace mneme::internal {
namespace {

constexpr int kMostPointsPerSphere = 400, kFewestPointsPerSphere = 60;
constexpr int kPointsOfAll = 30000;
/// Metres; rounding must not exclude a point on a sphere's surface.
constexpr double kTolerance = 1e-9;

bool is_covered(const Vec3& point, const Sphere& sphere) {
  return (point - sphere.center).norm() <= sphere.radius + kTolerance;
}

bool is_covered(const Vec3& point, std::span<const Sphere> spheres) {
  return std::ranges::any_of(spheres, [&](const Sphere& s) { return is_covered(point, s); });
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

std::vector<Vec3> sample_near_surface(const SolidModel& solid, std::span<const Sphere> spheres) {
  const std::array<Vec3, 4> corners = {Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1),
                                       Vec3(-1, -1, 1)};
  LatestFirst latest_first;
  const auto is_bare = [&](const Vec3& point) {
    return !latest_first.any(spheres, [&](const Sphere& s) { return is_covered(point, s); });
  };
  std::vector<Vec3> points;
  for (const SolidModel::Voxel& voxel : solid.inner_voxels()) {
    if (voxel.is_whole) continue;
    for (const Vec3& corner : corners) {
      const Vec3 point = voxel.center + 0.25 * solid.voxel_size() * corner;
      if (is_bare(point) && solid.contains(point)) points.push_back(point);
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
  const int points = std::clamp(kPointsOfAll / std::max(1, static_cast<int>(spheres.size())),
                                kFewestPointsPerSphere, kMostPointsPerSphere);
  for (std::size_t s = 0; s < spheres.size(); ++s) {
    const double share = spheres[s].radius * spheres[s].radius;
    for (int i = 0; i < points; ++i) {
      const Vec3 point = spheres[s].center + spheres[s].radius * spiral_point(i, points);
      const bool is_hidden =
          is_covered(point, spheres.first(s)) || is_covered(point, spheres.subspan(s + 1));
      if (is_hidden) continue;
      const double outside = solid.excess(point);
      area += share;
      excess.mean += share * outside;
      excess.max = std::max(excess.max, outside);
    }
  }
  if (area > 0) excess.mean /= area;
  return excess;
}

namespace {

constexpr double kRelativeExcess = 0.4;
constexpr double kLeastExcess = 0.005;
/// Number of pieces per surface: fewer make spheres overlap more, more take time.
constexpr double kFewestPieces = 800;
constexpr double kMostPieces = 20000;
constexpr double kFewestAlong = 100;
constexpr std::int64_t kProbeEffort = 10'000'000;
constexpr std::int64_t kFinalEffort = 80'000'000;
constexpr int kHalvings = 4;
constexpr int kSurfaceSamples = 20000;
constexpr double kStepsPerMetre = 1e5;

double excess_for(const TriangleMesh& mesh, double excess) {
  const AxisBox bounds = box_around(mesh);
  Vec3 extents = bounds.high - bounds.low;
  std::ranges::sort(extents.reshaped());
  return std::min(excess, std::max(kRelativeExcess * extents[1], kLeastExcess));
}

double piece_size(const TriangleMesh& mesh, double excess) {
  const double area = surface_area(mesh);
  const AxisBox bounds = box_around(mesh);
  const double longest = (bounds.high - bounds.low).maxCoeff();
  const double most = std::max(std::sqrt(area / kFewestPieces), longest / kFewestAlong);
  return std::clamp(0.5 * excess, std::sqrt(area / kMostPieces), most);
}

/// Approximates one surface with different excesses.
class SurfaceFitter {
 public:
  explicit SurfaceFitter(const TriangleMesh& mesh)
      : mesh_(mesh), solid_(mesh), medial_balls_(solid_.medial_balls()) {}

  [[nodiscard]] std::vector<Sphere> fit(double excess, std::int64_t effort) {
    pieces_ = SolidPieces(mesh_, solid_, piece_size(mesh_, excess));
    Rng rng(1);
    return choose_spheres(propose_spheres(solid_, medial_balls_, pieces_.needed, excess, rng),
                          pieces_, effort, rng);
  }

  /// Returns roughly the least excess above `least` for which `count` spheres suffice.
  [[nodiscard]] double find_excess(double least, std::size_t count) {
    double low = least;
    double high = 2 * least;
    while (fit(high, kProbeEffort).size() > count) {
      low = high;
      high *= 2;
    }
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = std::sqrt(low * high);
      (fit(middle, kProbeEffort).size() > count ? low : high) = middle;
    }
    return high;
  }

  [[nodiscard]] std::vector<Sphere> finish(const std::vector<Sphere>& spheres) {
    return refine(spheres, pieces_, solid_);
  }
  [[nodiscard]] const SolidModel& solid() const { return solid_; }

 private:
  const TriangleMesh& mesh_;
  SolidModel solid_;
  std::vector<Sphere> medial_balls_;
  SolidPieces pieces_{{}};  ///< of the last fit()
};

/// The sphere on round numbers, still containing the given one.
Sphere rounded(const Sphere& sphere) {
  const Vec3 center = (sphere.center * kStepsPerMetre).array().round() / kStepsPerMetre;
  const double radius = sphere.radius + (center - sphere.center).norm();
  return {center, std::ceil(radius * kStepsPerMetre) / kStepsPerMetre};
}

/// Grows the sphere nearest to each uncovered point until it contains the point.
void cover_points(std::span<const Vec3> points, std::vector<Sphere>& spheres) {
  const auto gap = [](const Vec3& p, const Sphere& s) { return (p - s.center).norm() - s.radius; };
  for (const Vec3& p : points) {
    const auto nearest =
        std::ranges::min_element(spheres, {}, [&](const Sphere& s) { return gap(p, s); });
    nearest->radius += std::max(0.0, gap(p, *nearest));
  }
}

}  // namespace

LinkSpheres approximate_solid(const TriangleMesh& mesh, const SphereSettings& settings) {
  assert(!mesh.empty() && settings.max_spheres > 0);
  SurfaceFitter fitter(mesh);
  const auto most = static_cast<std::size_t>(settings.max_spheres);
  const double wanted = excess_for(mesh, settings.excess);
  LinkSpheres result;
  if (const auto fitted = fit_capsule(mesh, fitter.solid(), wanted)) {
    result.capsules = {fitted->capsule};
    result.mean_excess = fitted->excess.mean;
    result.max_excess = fitted->excess.max;
    return result;
  }
  result.spheres = fitter.fit(wanted, kFinalEffort);
  if (result.spheres.size() > most) {
    result.spheres = fitter.fit(fitter.find_excess(wanted, most), kFinalEffort);
  }
  result.spheres = fitter.finish(result.spheres);
  cover_points(sample_near_surface(fitter.solid(), result.spheres), result.spheres);
  for (Sphere& sphere : result.spheres) sphere = rounded(sphere);
  result.uncovered = uncovered_fraction(sample_surface(mesh, kSurfaceSamples), result.spheres);
  const Excess measured = measure_excess(result.spheres, fitter.solid());
  result.mean_excess = measured.mean;
  result.max_excess = measured.max;
  return result;
}

}  // namespace mneme::internal

namespace mneme {

Result<LinkSpheres> approximate_link(const Link& link, const SphereSettings& settings) {
  MNEME_TRY(internal::check_ranges(settings));
  return internal::link_surface(link).map([&](const internal::TriangleMesh& surface) {
    LinkSpheres result = internal::approximate_solid(surface, settings);
    result.link = link.name;
    return result;
  });
}

}  // namespace mneme
