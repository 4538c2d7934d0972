// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/surface_builder.h"

#include "base/fail.h"
#include "mesh/mesh_file.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace mneme::internal {
namespace {

constexpr double kFarthest = 1000;
/// Ear clipping takes quadratic time.
constexpr std::size_t kMostConcaveCorners = 400;
/// Corners that ear clipping compares for all polygons of a file: about a second. A million
/// triangles in polygons of 10 corners take 16 million.
constexpr std::size_t kMostEarSteps = 20'000'000;

/// The vector area of a polygon, across its plane (Newell's method).
Vec3 area_of(std::span<const Vec3> corners) {
  Vec3 area = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    area += (corners[i] - corners[0]).cross(corners[i + 1] - corners[0]);
  }
  return area;
}

/// Cuts off ears: triangles of three successive corners without another corner inside. Cutting one
/// changes only whether its neighbours are ears (Eberly, Triangulation by ear clipping, 2002).
class EarClipper {
 public:
  EarClipper(std::span<const Vec3> corners, const Vec3& normal)
      : corners_(corners), normal_(normal) {
    for (std::size_t i = 0; i < corners.size(); ++i) {
      before_.push_back(i == 0 ? corners.size() - 1 : i - 1);
      after_.push_back((i + 1) % corners.size());
    }
    for (std::size_t i = 0; i < corners.size(); ++i) is_ear_.push_back(find_ear(i));
  }

  std::vector<std::array<std::size_t, 3>> run() {
    std::vector<std::array<std::size_t, 3>> triangles;
    std::size_t at = 0;
    for (std::size_t left = corners_.size(); left > 3; --left) {
      // A polygon that crosses itself may have no ear: then any corner is cut off.
      for (std::size_t i = 0; i < left && !is_ear_[at]; ++i) at = after_[at];
      const std::size_t before = before_[at], after = after_[at];
      triangles.push_back({before, at, after});
      after_[before] = after;
      before_[after] = before;
      is_ear_[before] = find_ear(before);
      is_ear_[after] = find_ear(after);
      at = before;
    }
    triangles.push_back({before_[at], at, after_[at]});
    return triangles;
  }
  /// Number of corners compared so far.
  [[nodiscard]] std::size_t steps() const { return steps_; }

 private:
  /// Positive if c is to the left of the line from a to b.
  [[nodiscard]] double turn(const Vec3& a, const Vec3& b, const Vec3& c) const {
    return normal_.dot((b - a).cross(c - a));
  }

  [[nodiscard]] bool find_ear(std::size_t at) {
    const Vec3 &a = corners_[before_[at]], &b = corners_[at], &c = corners_[after_[at]];
    if (turn(a, b, c) <= 0) return false;
    for (std::size_t i = after_[after_[at]]; i != before_[at]; i = after_[i]) {
      ++steps_;
      const Vec3& p = corners_[i];
      const bool is_corner = p == a || p == b || p == c;
      if (!is_corner && turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0)
        return false;
    }
    return true;
  }

  std::span<const Vec3> corners_;
  Vec3 normal_;
  std::vector<std::size_t> before_, after_;
  std::vector<bool> is_ear_;
  std::size_t steps_ = 0;
};

bool is_convex(std::span<const Vec3> corners, const Vec3& normal) {
  const std::size_t count = corners.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 &a = corners[i], &b = corners[(i + 1) % count], &c = corners[(i + 2) % count];
    if (normal.dot((b - a).cross(c - b)) < 0) return false;
  }
  return true;
}

}  // namespace

std::vector<std::array<std::size_t, 3>> SurfaceBuilder::triangulate(std::span<const Vec3> corners) {
  if (corners.size() < 3) return {};
  if (corners.size() - 2 > kMaxTriangles) fail_too_many();
  const Vec3 normal = area_of(corners);
  if (corners.size() > 3 && !is_convex(corners, normal)) {
    if (corners.size() > kMostConcaveCorners) {
      throw_failure(ErrorCode::unsupported,
                    "{}: has a concave polygon with {} corners, expected at most {}; triangulate "
                    "the mesh before",
                    source_, corners.size(), kMostConcaveCorners);
    }
    EarClipper clipper(corners, normal);
    auto triangles = clipper.run();
    ear_steps_ += clipper.steps();
    if (ear_steps_ > kMostEarSteps) {
      throw_failure(ErrorCode::unsupported,
                    "{}: has too many concave polygons with many corners; triangulate the mesh "
                    "before",
                    source_);
    }
    return triangles;
  }
  std::vector<std::array<std::size_t, 3>> fan;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) fan.push_back({0, i, i + 1});
  return fan;
}

void SurfaceBuilder::add(const Vec3& a, const Vec3& b, const Vec3& c) {
  if (++count_ > kMaxTriangles) fail_too_many();
  const Triangle triangle{place(a), place(b), place(c)};
  if (triangle.area() > 0) triangles_.push_back(triangle);
}

void SurfaceBuilder::add_polygon(std::span<const Vec3> corners) {
  for (const auto& [a, b, c] : triangulate(corners)) add(corners[a], corners[b], corners[c]);
}

void SurfaceBuilder::fail_too_many() const {
  throw_failure(ErrorCode::unsupported, "{}: has too many triangles, expected at most {}", source_,
                kMaxTriangles);
}

Vec3 SurfaceBuilder::place(const Vec3& corner) const {
  const Vec3 p = corner.cwiseProduct(scale_);
  // The first comparison is false for NaN.
  if (!(p.cwiseAbs().maxCoeff() <= kFarthest) || !p.allFinite()) {
    throw_failure(ErrorCode::parse,
                  "{}: a vertex is at ({}, {}, {}), expected coordinates within {} m", source_,
                  p.x(), p.y(), p.z(), kFarthest);
  }
  return pose_ * p;
}

std::vector<Triangle> SurfaceBuilder::take() {
  if (triangles_.empty()) {
    throw_failure(ErrorCode::parse, "{}: has no {}, expected a surface", source_,
                  count_ == 0 ? "triangles" : "triangle with an area");
  }
  return std::move(triangles_);
}

}  // namespace mneme::internal
