// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/axis_box.h"
#include "geometry/solids.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <cmath>
#include <limits>
#include <numbers>

namespace mneme::internal {
namespace {

template <class Visit>
void each_corner(const CloudPoint& p, const Visit& visit) {
  visit(to_vec3(p));
}
template <class Visit>
void each_corner(const Triangle& t, const Visit& visit) {
  for (const Vec3& corner : {t.a, t.b, t.c}) visit(corner);
}
template <class Visit>
void each_corner(const Cube& c, const Visit& visit) {
  for (const double x : {-1, 1}) {
    for (const double y : {-1, 1}) {
      for (const double z : {-1, 1}) visit(Vec3(c.center + c.half_extent * Vec3(x, y, z)));
    }
  }
}

/// Weight of a part by area or volume, so that tessellation does not matter.
double weight_of(const CloudPoint& /*point*/) { return 1; }
double weight_of(const Triangle& triangle) { return triangle.area(); }
double weight_of(const Cube& cube) { return std::pow(cube.half_extent, 3); }

/// Principal axes of every `stride`-th part.
template <class Part>
Eigen::Matrix3d principal_axes(const std::vector<Part>& parts, std::size_t stride) {
  double weight = std::numeric_limits<double>::min();  // avoids division by zero
  Vec3 first = Vec3::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < parts.size(); i += stride) {
    const Part& part = parts[i];
    const double share = weight_of(part);
    Vec3 sum = Vec3::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    double count = 0;
    each_corner(part, [&](const Vec3& p) {
      sum += p;
      squares += p * p.transpose();
      ++count;
    });
    weight += share;
    first += share / count * sum;
    // Exact for points and triangles. Too large for cubes, but equally in all directions.
    second += share / (count * (count + 1)) * (squares + sum * sum.transpose());
  }
  first /= weight;
  const Eigen::Matrix3d covariance = second / weight - first * first.transpose();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors();
}

/// Extent of every `stride`-th part in the frame `axes`.
template <class Part>
AxisBox extent(const std::vector<Part>& parts, const Eigen::Matrix3d& axes, std::size_t stride) {
  AxisBox box;
  for (std::size_t i = 0; i < parts.size(); i += stride) {
    each_corner(parts[i], [&](const Vec3& p) { box.include(Vec3(axes.transpose() * p)); });
  }
  return box;
}

double surface_of(const AxisBox& box) {
  const Vec3 size = box.high - box.low;
  return size.x() * size.y() + size.y() * size.z() + size.z() * size.x();
}

}  // namespace

// Principal axes are ambiguous for symmetric shapes. So a search over turns about each axis
// follows, for the smallest box around a sample of the parts.
template <class Part>
Box oriented_box(const CompoundShape<Part>& compound) {
  constexpr std::size_t kSampleSize = 100;
  constexpr double kCoarse = std::numbers::pi / 16, kFine = 0.01;
  const std::vector<Part>& parts = compound.parts->list();
  const std::size_t stride = 1 + parts.size() / kSampleSize;
  Eigen::Matrix3d axes = principal_axes(parts, stride);
  if (axes.determinant() < 0) axes.col(0) *= -1;
  double least = surface_of(extent(parts, axes, stride));
  const auto turn = [&](const Vec3& about, double angle) {
    const Eigen::Matrix3d turned = axes * rotation_about(about, angle);
    const double surface = surface_of(extent(parts, turned, stride));
    if (surface >= least) return;
    least = surface;
    axes = turned;
  };
  for (const Vec3& about : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY()), Vec3(Vec3::UnitZ())}) {
    for (double angle = kCoarse; angle < std::numbers::pi / 4; angle *= 2) {
      for (const double side : {-1, 1}) turn(about, side * angle);
    }
    for (double angle = kCoarse; angle > kFine; angle *= 0.5) {
      for (const double side : {-1, 1}) turn(about, side * angle);
    }
  }
  const AxisBox around = extent(parts, axes, 1);
  const Transform X_axes{axes, axes * (0.5 * (around.low + around.high))};
  return {compound.pose * X_axes,
          0.5 * (around.high - around.low) + Vec3::Constant(compound.radius)};
}

template Box oriented_box(const PointCloud&);
template Box oriented_box(const Mesh&);
template Box oriented_box(const Octree&);

}  // namespace mneme::internal
