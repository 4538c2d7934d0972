// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/parts.h"
#include "geometry/solids.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <type_traits>

namespace mneme {

Eigen::Matrix3d rotation_about(const Vec3& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

Eigen::Matrix3d rotation_from_rpy(const Vec3& rpy) {
  return rotation_about(Vec3::UnitZ(), rpy.z()) * rotation_about(Vec3::UnitY(), rpy.y()) *
         rotation_about(Vec3::UnitX(), rpy.x());
}

Eigen::Matrix3d rotation_from_quaternion(double w, double x, double y, double z) {
  Eigen::Quaterniond quaternion(w, x, y, z);
  quaternion.coeffs().stableNormalize();
  return quaternion.toRotationMatrix();
}

namespace {

struct Move {
  const Transform& X_AB;
  Shape operator()(Sphere s) const {
    s.center = X_AB * s.center;
    return s;
  }
  Shape operator()(Capsule s) const {
    s.a = X_AB * s.a;
    s.b = X_AB * s.b;
    return s;
  }
  template <class Posed>
  Shape operator()(Posed s) const {
    s.pose = X_AB * s.pose;
    return s;
  }
};

struct Bound {
  Sphere operator()(const Sphere& s) const { return s; }
  Sphere operator()(const Box& s) const { return {s.pose.translation, s.half_extents.norm()}; }
  Sphere operator()(const Cylinder& s) const {
    return {s.pose.translation, std::hypot(s.radius, 0.5 * s.length)};
  }
  Sphere operator()(const Capsule& s) const {
    return {0.5 * (s.a + s.b), 0.5 * (s.b - s.a).norm() + s.radius};
  }
  template <class Part>
  Sphere operator()(const CompoundShape<Part>& s) const {
    const internal::AxisBox box = internal::PartsAccess::bounds(*s.parts);
    return {s.pose * Vec3(0.5 * (box.low + box.high)),
            0.5 * (box.high - box.low).norm() + s.radius};
  }
};

struct Sizes {
  std::vector<double> operator()(const Sphere& s) const { return {s.radius}; }
  std::vector<double> operator()(const Box& s) const {
    return {2 * s.half_extents[0], 2 * s.half_extents[1], 2 * s.half_extents[2]};
  }
  std::vector<double> operator()(const Cylinder& s) const { return {s.radius, s.length}; }
  std::vector<double> operator()(const Capsule& s) const { return {s.radius, (s.b - s.a).norm()}; }
  template <class Part>
  std::vector<double> operator()(const CompoundShape<Part>&) const {
    return {};
  }
};

struct Resize {
  std::span<const double> sizes;
  Shape operator()(const Sphere& s) const { return Sphere{s.center, sizes[0]}; }
  Shape operator()(const Box& s) const {
    return Box{s.pose, 0.5 * Vec3(sizes[0], sizes[1], sizes[2])};
  }
  Shape operator()(const Cylinder& s) const { return Cylinder{s.pose, sizes[0], sizes[1]}; }
  /// Changes the length at both ends.
  Shape operator()(const Capsule& s) const {
    const Vec3 middle = 0.5 * (s.a + s.b), along = s.b - s.a;
    const Vec3 direction = along.norm() > 0 ? Vec3(along.normalized()) : Vec3(Vec3::UnitZ());
    return Capsule{middle - 0.5 * sizes[1] * direction, middle + 0.5 * sizes[1] * direction,
                   sizes[0]};
  }
  template <class Part>
  Shape operator()(const CompoundShape<Part>& s) const {
    return s;
  }
};

struct Scale {
  const Vec3& about;
  double factor;
  [[nodiscard]] Vec3 at(const Vec3& point) const { return about + factor * (point - about); }
  [[nodiscard]] Transform at(const Transform& pose) const {
    return {pose.rotation, at(pose.translation)};
  }
  Shape operator()(const Sphere& s) const { return Sphere{at(s.center), s.radius * factor}; }
  Shape operator()(const Box& s) const { return Box{at(s.pose), s.half_extents * factor}; }
  Shape operator()(const Cylinder& s) const {
    return Cylinder{at(s.pose), s.radius * factor, s.length * factor};
  }
  Shape operator()(const Capsule& s) const { return Capsule{at(s.a), at(s.b), s.radius * factor}; }
  [[nodiscard]] CloudPoint grown(const CloudPoint& p) const {
    const auto f = static_cast<float>(factor);
    return {f * p[0], f * p[1], f * p[2]};
  }
  [[nodiscard]] Triangle grown(const Triangle& t) const {
    return {factor * t.a, factor * t.b, factor * t.c};
  }
  [[nodiscard]] Cube grown(const Cube& c) const {
    return {factor * c.center, factor * c.half_extent};
  }
  template <class Part>
  Shape operator()(const CompoundShape<Part>& s) const {
    std::vector<Part> parts;
    parts.reserve(s.parts->list().size());
    for (const Part& part : s.parts->list()) parts.push_back(grown(part));
    return CompoundShape<Part>{at(s.pose), std::make_shared<Parts<Part>>(std::move(parts)),
                               s.radius * factor};
  }
};

struct MomentsOf {
  using Moments = internal::Moments;
  static constexpr double kThinnest = 1e-9;  ///< half thickness, metres
  static Moments posed(double volume, const Transform& pose, const Vec3& variances) {
    return {volume, pose.translation,
            pose.rotation * variances.asDiagonal() * pose.rotation.transpose()};
  }
  Moments operator()(const Sphere& s) const {
    const double r = s.radius;
    return posed(4.0 / 3 * std::numbers::pi * r * r * r, {Eigen::Matrix3d::Identity(), s.center},
                 Vec3::Constant(r * r / 5));
  }
  Moments operator()(const Box& s) const {
    // A flat box keeps its place and two directions.
    const Vec3 half = s.half_extents.cwiseMax(kThinnest);
    return posed(8 * half.prod(), s.pose, half.cwiseAbs2() / 3);
  }
  Moments operator()(const Cylinder& s) const {
    const double across = s.radius * s.radius / 4;
    return posed(std::numbers::pi * s.radius * s.radius * s.length, s.pose,
                 {across, across, s.length * s.length / 12});
  }
  Moments operator()(const Capsule& s) const {
    const Vec3 along = s.b - s.a;
    const double length = along.norm();
    const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(
        Vec3::UnitZ(), length > 0 ? Vec3(along / length) : Vec3(Vec3::UnitZ()));
    return (*this)(Cylinder{
        {turn.toRotationMatrix(), 0.5 * (s.a + s.b)}, s.radius, length + 4.0 / 3 * s.radius});
  }
  template <class Part>
  Moments operator()(const CompoundShape<Part>& s) const {
    return (*this)(internal::oriented_box(s));
  }
};

/// Comparisons are false for NaN, which is a flaw.
struct FindFlaw {
  static constexpr std::string_view kSize = "has a size that is not positive";
  static constexpr std::string_view kPose = "is posed by a matrix that is no rotation";

  std::string_view operator()(const Sphere& s) const { return s.radius > 0 ? "" : kSize; }
  std::string_view operator()(const Capsule& s) const { return s.radius > 0 ? "" : kSize; }
  std::string_view operator()(const Box& s) const {
    if (!(s.half_extents.array() > 0).all()) return kSize;
    return internal::is_rotation(s.pose.rotation) ? "" : kPose;
  }
  std::string_view operator()(const Cylinder& s) const {
    if (!(s.radius > 0 && s.length > 0)) return kSize;
    return internal::is_rotation(s.pose.rotation) ? "" : kPose;
  }
  template <class Part>
  std::string_view operator()(const CompoundShape<Part>& s) const {
    constexpr double kLeastRadius = std::is_same_v<Part, CloudPoint> ? 1e-9 : 0;
    if (!s.parts || s.parts->list().empty()) return "has no parts";
    if (!(s.radius >= kLeastRadius)) return "has a radius that is not positive";
    if (internal::PartsAccess::bounds(*s.parts).is_empty()) {
      return "has a part that is not finite or has a negative size";
    }
    return internal::is_rotation(s.pose.rotation) ? "" : kPose;
  }
};

}  // namespace

std::string_view shape_name(const Shape& shape) {
  constexpr std::array<std::string_view, std::variant_size_v<Shape>> kNames = {
      "sphere", "box", "cylinder", "capsule", "points", "mesh", "octree"};
  return kNames[shape.index()];
}

Shape transformed(const Transform& X_AB, const Shape& shape) {
  return std::visit(Move{X_AB}, shape);
}

Sphere bounding_sphere(const Shape& shape) { return std::visit(Bound{}, shape); }

double Triangle::area() const { return 0.5 * (b - a).cross(c - a).norm(); }

namespace internal {
bool is_rotation(const Eigen::Matrix3d& matrix) {
  return (matrix * matrix.transpose()).isIdentity(1e-6) && matrix.determinant() > 0;
}

bool is_compound(const Shape& shape) {
  return std::visit(
      [](const auto& s) {
        return requires { s.parts; };
      },
      shape);
}

std::size_t part_count(const Shape& shape) {
  return std::visit(
      [](const auto& s) -> std::size_t {
        if constexpr (requires { s.parts; }) return s.parts->list().size();
        return 0;
      },
      shape);
}

std::vector<double> sizes_of(const Shape& shape) { return std::visit(Sizes{}, shape); }

Shape resized(const Shape& shape, std::span<const double> sizes) {
  return std::visit(Resize{sizes}, shape);
}

Shape scaled(const Shape& shape, const Vec3& about, double factor) {
  return std::visit(Scale{about, factor}, shape);
}

Moments moments_of(const Shape& shape) { return std::visit(MomentsOf{}, shape); }

std::string_view find_flaw(const Shape& shape) {
  const std::string_view flaw = std::visit(FindFlaw{}, shape);
  if (!flaw.empty()) return flaw;
  const Sphere bound = bounding_sphere(shape);
  return bound.center.allFinite() && std::isfinite(bound.radius) ? "" : "is not finite";
}

std::string said_of(const Shape& shape, std::string_view flaw) {
  const bool is_cloud = std::holds_alternative<PointCloud>(shape);
  return fmt::format("its {} {}", is_cloud ? "cloud" : shape_name(shape), flaw);
}

}  // namespace internal
}  // namespace mneme
