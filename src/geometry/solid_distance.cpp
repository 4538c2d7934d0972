// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/solid_distance.h"

#include "base/as_index.h"
#include "geometry/enclosure.h"
#include "geometry/part_distance.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mneme::internal {
namespace {

/// A point of a convex solid that is farthest in a direction.
Vec3 support(const Box& s, const Vec3& direction) {
  const Vec3 local = s.pose.rotation.transpose() * direction;
  return s.pose * Vec3(local.array().sign() * s.half_extents.array());
}

Vec3 support(const Cylinder& s, const Vec3& direction) {
  const Vec3 local = s.pose.rotation.transpose() * direction;
  const double across = local.head<2>().norm();
  const double share = across > 0 ? s.radius / across : 0;
  return s.pose *
         Vec3(share * local.x(), share * local.y(), std::copysign(0.5 * s.length, local.z()));
}

Vec3 support(const Triangle& t, const Vec3& direction) {
  return std::max({t.a, t.b, t.c}, [&](const Vec3& p, const Vec3& q) {
    return direction.dot(p) < direction.dot(q);
  });
}

double distance_from(const Vec3& a, const Vec3& b, const Triangle& t) {
  return distance_between(a, b, t);
}

double distance_from(const Vec3& a, const Vec3& b, const Shape& solid) {
  return distance_to_segment(a, b, solid);
}

/// Of a convex solid. Where no edge of the triangle is nearest, and none meets the solid, either
/// the solid's support towards the triangle is, or the segment between both supports crosses it.
template <class Convex>
double gap(const Triangle& t, const Convex& solid) {
  const double least = std::min({distance_from(t.a, t.b, solid), distance_from(t.b, t.c, solid),
                                 distance_from(t.c, t.a, solid)});
  if (least == 0) return 0;
  const Vec3 normal = (t.b - t.a).cross(t.c - t.a);
  return std::min(least, distance_between(support(solid, normal), support(solid, -normal), t));
}

double gap(const Triangle& t, const CloudPoint& p) {
  const Vec3 point(p[0], p[1], p[2]);
  return distance_between(point, point, t);
}

double gap(const Triangle& t, const Cube& cube) {
  return gap(t, Box{{Eigen::Matrix3d::Identity(), cube.center}, Vec3::Constant(cube.half_extent)});
}

template <class Convex>
AxisBox bounds(const Convex& solid) {
  AxisBox box;
  for (int axis = 0; axis < 3; ++axis) {
    box.include(support(solid, Vec3::Unit(axis)));
    box.include(support(solid, -Vec3::Unit(axis)));
  }
  return box;
}

/// About its centroid.
double radius_of(const Triangle& t) {
  const Vec3 center = t.centroid();
  return std::sqrt(std::max(
      {(t.a - center).squaredNorm(), (t.b - center).squaredNorm(), (t.c - center).squaredNorm()}));
}

Vec3 point_of(const CloudPoint& p) { return {p[0], p[1], p[2]}; }
Vec3 point_of(const Triangle& t) { return t.a; }
Vec3 point_of(const Cube& cube) { return cube.center; }

/// The distance from shapes in the surface's frame.
class FromSurface {
 public:
  explicit FromSurface(const Mesh& surface)
      : surface_{{}, surface.parts, 0}, tree_(PartsAccess::tree(*surface.parts)) {}

  double operator()(const Sphere& s) const {
    return (*this)(Capsule{s.center, s.center, s.radius});
  }
  double operator()(const Capsule& s) const {
    return unless_inside(nearest_part(surface_, s.a, s.b).distance - s.radius, s.a);
  }
  double operator()(const Box& s) const { return from_convex(s); }
  double operator()(const Cylinder& s) const { return from_convex(s); }

  template <class Part>
  double operator()(const Crowd<Part>& s) const {
    const std::vector<Part>& parts = s.parts->list();
    const auto tree = PartsAccess::tree(*s.parts);
    const Transform X = s.pose.inverse();
    double least = std::numeric_limits<double>::infinity();
    for (const int i : tree_->order()) {
      const Triangle& t = surface_.parts->list()[as_index(i)];
      const Triangle own{X * t.a, X * t.b, X * t.c};
      const auto distance_to = [&](int k) { return gap(own, parts[as_index(k)]); };
      least = tree->nearest(box_of(own), distance_to, least).distance;
    }
    const bool is_apart = least > s.radius && std::ranges::all_of(parts, [&](const Part& part) {
                            return is_outside(s.pose * point_of(part));
                          });
    return is_apart ? least - s.radius : 0;
  }

 private:
  template <class Convex>
  double from_convex(const Convex& s) const {
    const Shape solid = s;
    double least = std::numeric_limits<double>::infinity();
    const auto distance_to = [&](int i) {
      const Triangle& t = surface_.parts->list()[as_index(i)];
      const double bound = distance(t.centroid(), solid) - radius_of(t);
      if (bound < least) least = std::min(least, gap(t, s));
      return least;
    };
    static_cast<void>(tree_->nearest(bounds(s), distance_to));
    return unless_inside(least, s.pose.translation);
  }

  /// `distance`, or 0 if it is none or `point` may be inside.
  double unless_inside(double distance, const Vec3& point) const {
    return distance > 0 && is_outside(point) ? distance : 0;
  }

  /// True if the lines say so and one of them leaves the surface without crossing it: solids that
  /// overlap mislead those that count.
  bool is_outside(const Vec3& point) const {
    if (distance2(tree_->nodes().front().box, {point, point}) > 0) return true;
    bool leaves = false;
    const bool is_in = is_enclosed(point, [&](const Line& line) {
      const Crossings crossings = crossings_of(line);
      leaves |= crossings.ahead == 0 || crossings.behind == 0;
      return crossings;
    });
    return leaves && !is_in;
  }

  Crossings crossings_of(const Line& line) const {
    Crossings crossings;
    std::vector<int> open = {0};
    while (!open.empty()) {
      const int index = open.back();
      open.pop_back();
      const BoxTree::Node& node = tree_->nodes()[as_index(index)];
      if (!line.meets(node.box)) continue;
      for (int i = node.first; i < node.first + node.count; ++i) {
        line.cross(surface_.parts->list()[as_index(tree_->order()[as_index(i)])], crossings);
      }
      if (node.right >= 0) open.insert(open.end(), {index + 1, node.right});
    }
    return crossings;
  }

  Mesh surface_;
  std::shared_ptr<const BoxTree> tree_;
};

}  // namespace

double distance_to_solid(const Mesh& surface, const Shape& shape) {
  return std::visit(FromSurface(surface), transformed(surface.pose.inverse(), shape));
}

}  // namespace mneme::internal
