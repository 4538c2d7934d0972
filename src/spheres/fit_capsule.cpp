// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "spheres/fit_capsule.h"

#include "base/threads.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace mneme::internal {
namespace {

constexpr int kExcessSamples = 2000;
constexpr int kCircleSteps = 500;
constexpr std::size_t kCirclePoints = 4000;
/// Metres; larger than the error of turning the capsule into the link's frame.
constexpr double kPoseRounding = 1e-6;
/// Shares of the allowed excess that the radius is enlarged by: a larger one has flatter caps.
constexpr std::array kShares = {0.02, 0.25, 0.5};

/// The principal axes of the surface as a shell, the longest last.
Eigen::Matrix3d principal_axes(const TriangleMesh& mesh) {
  const double area = surface_area(mesh);
  Vec3 mean = Vec3::Zero();
  for (const Triangle& t : mesh) mean += t.area() / area * t.centroid();
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  for (const Triangle& t : mesh) {
    const Vec3 a = t.a - mean, b = t.b - mean, c = t.c - mean, sum = a + b + c;
    moment += t.area() *
              (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moment).eigenvectors();
}

/// The corners of a mesh relative to a line: along it, and away from it.
struct Profile {
  std::vector<double> along, away;
};

/// The centre of nearly the smallest circle around the points, or some thousand of them. By Badoiu
/// and Clarkson, "Smaller core-sets for balls" (2003).
Eigen::Vector2d circle_center(const std::vector<Eigen::Vector2d>& all) {
  std::vector<Eigen::Vector2d> points;
  const std::size_t stride = 1 + all.size() / kCirclePoints;
  for (std::size_t i = 0; i < all.size(); i += stride) points.push_back(all[i]);
  Eigen::Vector2d center = points.front();
  for (int i = 1; i <= kCircleSteps; ++i) {
    const auto farthest = std::ranges::max_element(
        points, {}, [&](const Eigen::Vector2d& p) { return (p - center).squaredNorm(); });
    center += (*farthest - center) / (i + 1);
  }
  return center;
}

/// The shortest capsule of this radius on the z axis that contains the corners.
Capsule around(const Profile& profile, double radius) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t i = 0; i < profile.along.size(); ++i) {
    const double cap = std::sqrt(std::max(0.0, radius * radius - std::pow(profile.away[i], 2)));
    low = std::min(low, profile.along[i] + cap);
    high = std::max(high, profile.along[i] - cap);
  }
  if (low > high) low = high = 0.5 * (low + high);
  return {Vec3(0, 0, low), Vec3(0, 0, high), radius};
}

/// `count` points evenly on the surface of a capsule along the z axis.
std::vector<Vec3> sample_capsule(const Capsule& capsule, int count) {
  const double golden_angle = std::numbers::pi * (3 - std::sqrt(5.0));
  const double low = capsule.a.z(), high = capsule.b.z(), r = capsule.radius;
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    // By Archimedes, slices of equal height have equal area on caps and cylinder.
    const double z = low - r + (high - low + 2 * r) * (i + 0.5) / count;
    const double beyond = z < low ? z - low : std::max(0.0, z - high);
    const double away = std::sqrt(std::max(0.0, r * r - beyond * beyond));
    points.emplace_back(away * std::cos(golden_angle * i), away * std::sin(golden_angle * i), z);
  }
  return points;
}

/// How far the capsule sticks out; nothing if that is farther than `most`.
std::optional<Excess> measure(const Capsule& capsule, const Transform& pose,
                              const SolidModel& solid, double most) {
  Excess excess;
  for (const Vec3& p : sample_capsule(capsule, kExcessSamples)) {
    const double outside = solid.excess(pose * p);
    if (outside > most) return std::nullopt;
    excess.mean += outside / kExcessSamples;
    excess.max = std::max(excess.max, outside);
  }
  return excess;
}

}  // namespace

std::optional<FittedCapsule> fit_capsule(const TriangleMesh& mesh, const SolidModel& solid,
                                         double most) {
  poll_interrupt();
  const Eigen::Matrix3d axes = principal_axes(mesh);
  Transform pose;
  pose.rotation.col(2) = axes.col(2);
  pose.rotation.col(0) = axes.col(0);
  pose.rotation.col(1) = axes.col(2).cross(axes.col(0));
  std::vector<Eigen::Vector2d> across;
  Profile profile;
  for (const Triangle& t : mesh) {
    for (const Vec3& corner : {t.a, t.b, t.c}) {
      const Vec3 p = pose.rotation.transpose() * corner;
      across.emplace_back(p.head<2>());
      profile.along.push_back(p.z());
    }
  }
  const Eigen::Vector2d center = circle_center(across);
  pose.translation = pose.rotation * Vec3(center.x(), center.y(), 0);
  for (const auto& p : across) profile.away.push_back((p - center).norm());
  const double least = *std::ranges::max_element(profile.away);
  for (const double share : kShares) {
    const Capsule capsule = around(profile, least + share * most);
    const auto excess = measure(capsule, pose, solid, most);
    if (!excess || excess->mean > 0.5 * most) continue;
    return FittedCapsule{{pose * capsule.a, pose * capsule.b, capsule.radius + kPoseRounding},
                         *excess};
  }
  return std::nullopt;
}

namespace {

/// Returns the index of the sphere that rounds off a cylinder at `end`; nothing without one.
std::optional<std::size_t> find_ball(const Link& link, const Vec3& end, double radius) {
  constexpr double kSame = 1e-6;  // metres
  for (std::size_t i = 0; i < link.spheres.size(); ++i) {
    const Sphere& sphere = link.spheres[i];
    const bool is_there = (sphere.center - end).norm() <= kSame;
    if (is_there && std::abs(sphere.radius - radius) <= kSame) return i;
  }
  return std::nullopt;
}

}  // namespace

void join_capsules(Link& link) {
  std::vector<bool> is_joined(link.spheres.size(), false);  // two cylinders may share one
  std::erase_if(link.solids, [&](const Solid& solid) {
    const auto* cylinder = std::get_if<Cylinder>(&solid);
    if (cylinder == nullptr) return false;
    const Vec3 half = 0.5 * cylinder->length * Vec3::UnitZ();
    const auto first = find_ball(link, cylinder->pose * half, cylinder->radius);
    const auto second = find_ball(link, cylinder->pose * -half, cylinder->radius);
    if (!first || !second) return false;
    const Sphere &a = link.spheres[*first], &b = link.spheres[*second];
    link.capsules.push_back({a.center, b.center, std::max({a.radius, b.radius, cylinder->radius})});
    is_joined[*first] = is_joined[*second] = true;
    return true;
  });
  std::erase_if(link.spheres,
                [&, i = std::size_t{0}](const Sphere&) mutable { return is_joined[i++]; });
}

}  // namespace mneme::internal
