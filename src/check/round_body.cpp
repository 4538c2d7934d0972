// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "check/round_body.h"

#include "base/as_index.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace mneme::internal {
namespace {

/// The edges of a link's triangles, and the axes of its capsules. `X`: pose of the link.
std::vector<Capsule> edges_of(const ExactLink& link, const Transform& X) {
  std::vector<Capsule> edges;
  for (const Capsule& shape : link.shapes()) {
    edges.push_back({X * shape.a, X * shape.b, shape.radius});
  }
  for (const Mesh& surface : link.surfaces()) {
    const Transform X_surface = X * surface.pose;
    for (const Triangle& t : surface.parts->list()) {
      const std::array<Vec3, 3> corners = {X_surface * t.a, X_surface * t.b, X_surface * t.c};
      for (std::size_t i = 0; i < 3; ++i) {
        edges.push_back({corners[i], corners[(i + 1) % 3], surface.radius});
      }
    }
  }
  return edges;
}

/// Distance of a triangle from the z axis.
double distance_to_axis(const Triangle& t) {
  const std::array<Eigen::Vector2d, 3> corners = {t.a.head<2>(), t.b.head<2>(), t.c.head<2>()};
  double least = std::numeric_limits<double>::infinity();
  int left = 0, right = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector2d& a = corners[i];
    const Eigen::Vector2d edge = corners[(i + 1) % 3] - a;
    const double length2 = edge.squaredNorm();
    const double share = length2 > 0 ? std::clamp(-a.dot(edge) / length2, 0.0, 1.0) : 0;
    least = std::min(least, (a + share * edge).norm());
    ++(edge.x() * a.y() - edge.y() * a.x() > 0 ? left : right);
  }
  return left == 3 || right == 3 ? 0 : least;
}

}  // namespace

double radius_about_axis(const ExactLink& link, const Transform& X) {
  double radius = 0;
  for (const Capsule& edge : edges_of(link, X)) {
    const double farthest = std::max(edge.a.head<2>().norm(), edge.b.head<2>().norm());
    radius = std::max(radius, farthest + edge.radius);
  }
  return radius;
}

RoundBody::RoundBody(const ExactLink& link, const Transform& X) {
  const std::vector<Capsule> edges = edges_of(link, X);
  for (const Capsule& edge : edges) {
    low_ = std::min({low_, edge.a.z() - edge.radius, edge.b.z() - edge.radius});
    high_ = std::max({high_, edge.a.z() + edge.radius, edge.b.z() + edge.radius});
  }
  for (const Capsule& edge : edges) add(edge);
}

/// A triangle is farthest from the axis at its edges, and a segment at its ends.
void RoundBody::add(const Capsule& edge) {
  const double rise = edge.b.z() - edge.a.z();
  for (int slice = 0; slice < kSlices; ++slice) {
    const double begin = edge_of(slice) - edge.radius, end = edge_of(slice + 1) + edge.radius;
    if (std::max(edge.a.z(), edge.b.z()) < begin || std::min(edge.a.z(), edge.b.z()) > end)
      continue;
    double from = 0, to = 1;
    if (rise != 0) {
      from = std::clamp((begin - edge.a.z()) / rise, 0.0, 1.0);
      to = std::clamp((end - edge.a.z()) / rise, 0.0, 1.0);
    }
    const auto radius_at = [&](double t) {
      return (edge.a + t * (edge.b - edge.a)).head<2>().norm();
    };
    double& radius = radii_[as_index(slice)];
    radius = std::max(radius, std::max(radius_at(from), radius_at(to)) + edge.radius);
  }
}

/// True for points from `low` to `high` along the axis and `distance` metres or more away from it.
bool RoundBody::is_beyond(double distance, double low, double high, double margin) const {
  for (int slice = 0; slice < kSlices; ++slice) {
    const double beside = std::max({0.0, edge_of(slice) - high, low - edge_of(slice + 1)});
    const double beyond = std::max(0.0, distance - radii_[as_index(slice)]);
    if (beside * beside + beyond * beyond < margin * margin) return false;
  }
  return true;
}

bool RoundBody::is_beyond(const Triangle& t, double margin, int splits) const {
  const auto [low, high] = std::minmax({t.a.z(), t.b.z(), t.c.z()});
  const double distance = distance_to_axis(t);
  if (is_beyond(distance, low, high, margin)) return true;
  if (splits == 0 || !is_beyond(t.a.head<2>().norm(), t.a.z(), t.a.z(), margin)) {
    return false;
  }
  const Vec3 ab = 0.5 * (t.a + t.b), bc = 0.5 * (t.b + t.c), ca = 0.5 * (t.c + t.a);
  return is_beyond({ab, bc, ca}, margin, splits - 1) &&
         is_beyond({t.a, ab, ca}, margin, splits - 1) &&
         is_beyond({ab, t.b, bc}, margin, splits - 1) &&
         is_beyond({ca, bc, t.c}, margin, splits - 1);
}

bool RoundBody::is_clear_of(const SweptSolid& solid, const Transform& X,
                            const PointMargin& margin) const {
  constexpr int kMostSplits = 3;
  const Transform X_solid = X * solid.pose();
  const Eigen::Matrix3d extent = X_solid.rotation.cwiseAbs();
  std::vector<int> open = {0};
  while (!open.empty()) {
    const int index = open.back();
    open.pop_back();
    const BoxTree::Node& node = solid.tree().nodes()[as_index(index)];
    const Vec3 middle = 0.5 * (node.box.low + node.box.high);
    const Vec3 size = 0.5 * (node.box.high - node.box.low);
    const Vec3 center = X_solid * middle, half = extent * size;
    const double reach =
        margin.of(Sphere{solid.pose() * middle, size.norm() + solid.radius()}) + solid.radius();
    const double distance = center.head<2>().norm() - half.head<2>().norm();
    if (is_beyond(distance, center.z() - half.z(), center.z() + half.z(), reach)) continue;
    for (int i = node.first; i < node.first + node.count; ++i) {
      const int part = solid.tree().order()[as_index(i)];
      if (!is_clear_of(solid, part, X, margin, kMostSplits)) return false;
    }
    if (node.right >= 0) open.insert(open.end(), {index + 1, node.right});
  }
  return true;
}

bool RoundBody::is_clear_of(const SweptSolid& solid, int part, const Transform& X,
                            const PointMargin& margin, int splits) const {
  const Triangle& t = solid.triangle(part);
  const double radius = solid.radius() + solid.own_radius(part);
  Triangle posed;
  double most = 0;
  for (const auto corner : {&Triangle::a, &Triangle::b, &Triangle::c}) {
    const Vec3 point = solid.pose() * (t.*corner);
    // The farthest point from an axis is at a corner.
    most = std::max(most, margin.of(Sphere{point, radius}));
    posed.*corner = X * point;
  }
  return is_beyond(posed, most + radius, splits);
}

double RoundBody::reach_about(const Transform& X) const {
  double reach = 0;
  for (int slice = 0; slice < kSlices; ++slice) {
    for (const double at : {edge_of(slice), edge_of(slice + 1)}) {
      const double center = (X * Vec3(0, 0, at)).head<2>().norm();
      reach = std::max(reach, center + radii_[as_index(slice)]);
    }
  }
  return reach;
}

}  // namespace mneme::internal
