// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "covering/cover_solid.h"

#include <algorithm>
#include <cmath>

#include "covering/cover_quality.h"
#include "covering/cover_search.h"
#include "covering/elements.h"
#include "covering/refine.h"
#include "covering/solid_model.h"

namespace mneme::internal {
namespace {

constexpr double kRelativeExcess = 0.4;
constexpr double kLeastExcess = 0.005;
/// Pieces per surface: fewer make spheres overlap more than they must, more take time.
constexpr double kFewestPieces = 800;
constexpr double kMostPieces = 8000;
constexpr double kFewestAlong = 100;
constexpr std::int64_t kProbeEffort = 10'000'000;
constexpr std::int64_t kFinalEffort = 150'000'000;
constexpr int kHalvings = 4;
constexpr int kSurfaceSamples = 20000;
constexpr double kStepsPerMetre = 1e5;

double excess_for(const TriangleMesh& mesh, double excess) {
  const Bounds bounds = bounds_of(mesh);
  Vec3 extents = bounds.high - bounds.low;
  std::ranges::sort(extents.reshaped());
  return std::min(excess, std::max(kRelativeExcess * extents[1], kLeastExcess));
}

double piece_size(const TriangleMesh& mesh, double excess) {
  const double area = surface_area(mesh);
  const Bounds bounds = bounds_of(mesh);
  const double longest = (bounds.high - bounds.low).maxCoeff();
  const double most = std::max(std::sqrt(area / kFewestPieces), longest / kFewestAlong);
  return std::clamp(0.5 * excess, std::sqrt(area / kMostPieces), most);
}

/// One surface, covered again and again with different excesses.
class Coverer {
 public:
  explicit Coverer(const TriangleMesh& mesh)
      : mesh_(mesh), solid_(mesh), medial_balls_(solid_.medial_balls()) {}

  /// Few spheres that stick out by at most `excess`.
  [[nodiscard]] std::vector<Sphere> cover(double excess, std::int64_t effort) {
    elements_ = make_elements(mesh_, solid_, piece_size(mesh_, excess));
    Rng rng(1);
    return choose_spheres(propose_spheres(solid_, medial_balls_, elements_, excess, rng), elements_,
                          effort, rng);
  }

  /// The least excess, roughly, with which `count` spheres suffice.
  [[nodiscard]] double find_excess(double least, std::size_t count) {
    double low = least;
    double high = least;
    while (cover(high, kProbeEffort).size() > count) {
      low = high;
      high *= 2;
    }
    for (int i = 0; i < kHalvings && low < high; ++i) {
      const double middle = std::sqrt(low * high);
      (cover(middle, kProbeEffort).size() > count ? low : high) = middle;
    }
    return high;
  }

  [[nodiscard]] std::vector<Sphere> finish(std::vector<Sphere> spheres) const {
    return refine(std::move(spheres), elements_, solid_);
  }
  [[nodiscard]] const SolidModel& solid() const { return solid_; }

 private:
  const TriangleMesh& mesh_;
  SolidModel solid_;
  std::vector<Sphere> medial_balls_;
  std::vector<Element> elements_;
};

/// On round numbers, without leaving anything bare.
Sphere rounded(const Sphere& sphere) {
  const Vec3 center = (sphere.center * kStepsPerMetre).array().round() / kStepsPerMetre;
  const double radius = sphere.radius + (center - sphere.center).norm();
  return {center, std::ceil(radius * kStepsPerMetre) / kStepsPerMetre};
}

/// Grows the sphere that is nearest to each bare point.
void reach_all(std::span<const Vec3> points, std::vector<Sphere>& spheres) {
  const auto gap = [](const Vec3& p, const Sphere& s) { return (p - s.center).norm() - s.radius; };
  for (const Vec3& p : points) {
    const auto nearest =
        std::ranges::min_element(spheres, {}, [&](const Sphere& s) { return gap(p, s); });
    nearest->radius += std::max(0.0, gap(p, *nearest));
  }
}

}  // namespace

LinkCover cover_solid(const TriangleMesh& mesh, const CoverSettings& settings) {
  Coverer coverer(mesh);
  const auto most = static_cast<std::size_t>(settings.max_spheres);
  double excess = coverer.find_excess(excess_for(mesh, settings.excess), most);
  LinkCover cover;
  cover.spheres = coverer.finish(coverer.cover(excess, kFinalEffort));
  reach_all(sample_near_surface(coverer.solid()), cover.spheres);
  for (Sphere& sphere : cover.spheres) sphere = rounded(sphere);
  cover.uncovered = uncovered_fraction(sample_surface(mesh, kSurfaceSamples), cover.spheres);
  const Excess measured = measure_excess(cover.spheres, coverer.solid());
  cover.mean_excess = measured.mean;
  cover.max_excess = measured.max;
  return cover;
}

}  // namespace mneme::internal
