// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/solids.h"
#include "base/as_index.h"
#include "geometry/part_distance.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace mneme::internal {
namespace {

/// The point of a convex solid farthest in a direction.
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

/// Distance to a convex solid. If no edge of the triangle is nearest and none meets the solid, then
/// the solid's support point towards the triangle is nearest, or the segment between both supports
/// crosses the triangle.
template <class Convex>
double distance_to_convex(const Triangle& t, const Convex& solid) {
  const Shape shape = solid;
  const double least =
      std::min({distance_to_segment(t.a, t.b, shape), distance_to_segment(t.b, t.c, shape),
                distance_to_segment(t.c, t.a, shape)});
  if (least == 0) return 0;
  const Vec3 normal = (t.b - t.a).cross(t.c - t.a);
  return std::min(least, distance_between(support(solid, normal), support(solid, -normal), t));
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

/// Lower bound of the distance between a triangle and a convex solid: that from the plane through
/// the solid's point nearest to the centroid. Exact for a triangle parallel to a face below it.
template <class Convex>
double distance_at_least(const Triangle& t, const Convex& s) {
  const Vec3 center = t.centroid(), nearest = nearest_point(center, s);
  const Vec3 away = center - nearest;
  const double length = away.norm();
  if (length == 0) return 0;
  return std::min({away.dot(t.a - nearest), away.dot(t.b - nearest), away.dot(t.c - nearest)}) /
         length;
}

Vec3 point_of(const CloudPoint& p) { return to_vec3(p); }
Vec3 point_of(const Cube& cube) { return cube.center; }

/// Distance between two surfaces, by simultaneous descent of both trees.
class SurfaceGap {
 public:
  SurfaceGap(const Mesh& a, const Mesh& b)
      : a_(a.parts->list()),
        b_(b.parts->list()),
        tree_a_(PartsAccess::tree(*a.parts)),
        tree_b_(PartsAccess::tree(*b.parts)),
        X_AB_(a.pose.inverse() * b.pose),
        extent_(X_AB_.rotation.cwiseAbs()) {}

  /// The distance if less than `limit` > 0, otherwise infinity.
  double less_than(double limit) {
    least_ = limit;
    if (is_within(reach2(0, 0))) search(0, 0);
    return least_ < limit ? least_ : std::numeric_limits<double>::infinity();
  }

 private:
  using Nodes = std::pair<int, int>;
  struct Boxed {
    Triangle triangle;
    AxisBox box;
  };

  void search(int i, int k) {
    const BoxTree::Node &a = tree_a_->nodes()[as_index(i)], &b = tree_b_->nodes()[as_index(k)];
    if (a.right < 0 && b.right < 0) return compare(a, b);
    const bool splits_a = b.right < 0 || (a.right >= 0 && size2(a) > size2(b));
    Nodes near = splits_a ? Nodes{i + 1, k} : Nodes{i, k + 1};
    Nodes far = splits_a ? Nodes{a.right, k} : Nodes{i, b.right};
    double near2 = reach2(near.first, near.second), far2 = reach2(far.first, far.second);
    if (far2 < near2) {
      std::swap(near, far);
      std::swap(near2, far2);
    }
    if (is_within(near2)) search(near.first, near.second);
    if (is_within(far2)) search(far.first, far.second);
  }

  void compare(const BoxTree::Node& a, const BoxTree::Node& b) {
    own_.clear();
    const AxisBox around_b = moved(b.box);
    for (int i = a.first; i < a.first + a.count; ++i) {
      const Triangle& t = a_[as_index(tree_a_->order()[as_index(i)])];
      if (const AxisBox box = box_of(t); is_within(distance2(box, around_b))) {
        own_.push_back({t, box});
      }
    }
    for (int k = b.first; k < b.first + b.count && !own_.empty(); ++k) {
      const Triangle& t = b_[as_index(tree_b_->order()[as_index(k)])];
      const Triangle other{X_AB_ * t.a, X_AB_ * t.b, X_AB_ * t.c};
      const AxisBox box = box_of(other);
      if (!is_within(distance2(a.box, box))) continue;
      for (const Boxed& own : own_) {
        if (!is_within(distance2(own.box, box))) continue;
        least_ = distance_between(own.triangle, other, least_);
      }
    }
  }

  static double size2(const BoxTree::Node& node) {
    return (node.box.high - node.box.low).squaredNorm();
  }
  [[nodiscard]] bool is_within(double distance2) const { return distance2 < least_ * least_; }

  [[nodiscard]] double reach2(int i, int k) const {
    return distance2(tree_a_->nodes()[as_index(i)].box, moved(tree_b_->nodes()[as_index(k)].box));
  }

  /// A box around a box of b, in a's frame.
  [[nodiscard]] AxisBox moved(const AxisBox& b) const {
    const Vec3 middle = X_AB_ * Vec3(0.5 * (b.low + b.high));
    const Vec3 half = extent_ * (0.5 * (b.high - b.low));
    return {middle - half, middle + half};
  }

  const std::vector<Triangle>&a_, &b_;
  std::shared_ptr<const BoxTree> tree_a_, tree_b_;
  Transform X_AB_;
  Eigen::Matrix3d extent_;
  std::vector<Boxed> own_;  ///< triangles of a leaf that may be near the other leaf
  double least_ = 0;
};

/// A box around another one that stands at X.
AxisBox around(const Transform& X, const AxisBox& box) {
  const Vec3 middle = X * Vec3(0.5 * (box.low + box.high));
  const Vec3 half = X.rotation.cwiseAbs() * (0.5 * (box.high - box.low));
  return {middle - half, middle + half};
}

/// Distances to shapes in the surface's frame.
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
  double operator()(const Mesh& s) const {
    const double least = SurfaceGap(surface_, s).less_than(std::numeric_limits<double>::infinity());
    return least > s.radius && !may_enclose(s) ? least - s.radius : 0;
  }

  /// True unless lines show that no piece of the shape, which does not meet the surface, is inside.
  bool may_enclose(const Shape& shape) const {
    return std::visit([this](const auto& s) { return may_enclose(s); }, shape);
  }
  bool may_enclose(const Sphere& s) const { return !is_outside(s.center); }
  bool may_enclose(const Capsule& s) const { return !is_outside(s.a); }
  bool may_enclose(const Box& s) const { return !is_outside(s.pose.translation); }
  bool may_enclose(const Cylinder& s) const { return !is_outside(s.pose.translation); }
  bool may_enclose(const Mesh& s) const {
    const AxisBox box = around(s.pose, PartsAccess::tree(*s.parts)->nodes().front().box);
    if (distance2(tree_->nodes().front().box, box) > 0) return false;
    const auto is_in_box = [&](const Vec3& p) {
      const Vec3 q = s.pose * p;
      return distance2(tree_->nodes().front().box, {q, q}) == 0;
    };
    const auto pieces = PartsAccess::pieces(*s.parts);
    return std::ranges::any_of(pieces->corners, [&](const PieceCorners& corners) {
      return std::ranges::all_of(corners, is_in_box) && !is_outside(s.pose * corners[0]);
    });
  }
  template <class Part>
  bool may_enclose(const CompoundShape<Part>& s) const {
    return std::ranges::any_of(
        s.parts->list(), [&](const Part& part) { return !is_outside(s.pose * point_of(part)); });
  }

  template <class Part>
  double operator()(const CompoundShape<Part>& s) const {
    const std::vector<Part>& parts = s.parts->list();
    const auto tree = PartsAccess::tree(*s.parts);
    const Transform X = s.pose.inverse();
    double least = std::numeric_limits<double>::infinity();
    for (const int i : tree_->order()) {
      const Triangle& t = surface_.parts->list()[as_index(i)];
      const Triangle own{X * t.a, X * t.b, X * t.c};
      const auto distance_to = [&](int k) { return distance_between(own, parts[as_index(k)]); };
      least = tree->nearest(box_of(own), distance_to, least).distance;
    }
    return least > s.radius && !may_enclose(s) ? least - s.radius : 0;
  }

 private:
  template <class Convex>
  double from_convex(const Convex& s) const {
    // Triangles of one face are all as near: rounding must not make each of them count.
    constexpr double kRounding = 1e-12;
    double least = std::numeric_limits<double>::infinity();
    const auto distance_to = [&](int i) {
      const Triangle& t = surface_.parts->list()[as_index(i)];
      if (distance_at_least(t, s) < least - kRounding) {
        least = std::min(least, distance_between(t, s));
      }
      return least;
    };
    static_cast<void>(tree_->nearest(bounds(s), distance_to));
    return unless_inside(least, s.pose.translation);
  }

  /// `distance`, or 0 if it is negative or `point` may be inside.
  double unless_inside(double distance, const Vec3& point) const {
    return distance > 0 && is_outside(point) ? distance : 0;
  }

  /// True if the point is proven to be outside of the solid.
  bool is_outside(const Vec3& point) const {
    if (distance2(tree_->nodes().front().box, {point, point}) > 0) return true;
    if (!PartsAccess::pieces(*surface_.parts)->are_solids) return is_reached(point);
    const auto crossings_of_line = [&](const Line& line) {
      return crossings_of(line, *surface_.parts);
    };
    return winding_number(point, crossings_of_line) == 0;
  }

  /// True if the crossings are even and one line reaches the point from outside: counts are
  /// unreliable for a surface with a rim or with pieces that enclose nothing.
  bool is_reached(const Vec3& point) const {
    bool leaves = false;
    const bool is_in = is_enclosed(point, [&](const Line& line) {
      const Crossings crossings = crossings_of(line, *surface_.parts);
      leaves |= crossings.leave();
      return crossings;
    });
    if (is_in || leaves) return !is_in;
    // Few lines leave a deep cup. A line has two ends: half of the sphere suffices.
    constexpr int kLines = 50;
    for (int i = 0; i < kLines; ++i) {
      const Line line(point, spiral_point(i, 2 * kLines));
      if (crossings_of(line, *surface_.parts).leave()) return true;
    }
    return false;
  }

  Mesh surface_;
  std::shared_ptr<const BoxTree> tree_;
};

}  // namespace

double distance_between(const Triangle& t, const Box& box) { return distance_to_convex(t, box); }
double distance_between(const Triangle& t, const Cylinder& cylinder) {
  return distance_to_convex(t, cylinder);
}
double distance_between(const Triangle& t, const CloudPoint& point) {
  return distance_between(to_vec3(point), to_vec3(point), t);
}
double distance_between(const Triangle& t, const Cube& cube) {
  const Box box{{Eigen::Matrix3d::Identity(), cube.center}, Vec3::Constant(cube.half_extent)};
  return distance_to_convex(t, box);
}

bool may_enclose(const Mesh& surface, const Shape& shape) {
  return FromSurface(surface).may_enclose(transformed(surface.pose.inverse(), shape));
}

double distance_to_solid(const Mesh& surface, const Shape& shape) {
  return std::visit(FromSurface(surface), transformed(surface.pose.inverse(), shape));
}

double distance_between_solids(const Mesh& a, const Mesh& b, double enough) {
  const double least = SurfaceGap(a, b).less_than(enough);
  const Transform X_AB = a.pose.inverse() * b.pose;
  const bool is_one_inside = FromSurface(a).may_enclose(Mesh{X_AB, b.parts, 0}) ||
                             FromSurface(b).may_enclose(Mesh{X_AB.inverse(), a.parts, 0});
  return is_one_inside ? 0 : least;
}

}  // namespace mneme::internal
