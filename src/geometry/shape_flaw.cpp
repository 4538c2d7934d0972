// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/parts.h"
#include "geometry/solids.h"

#include <Eigen/LU>
#include <fmt/format.h>

#include <cmath>
#include <type_traits>

namespace mneme::internal {
namespace {

bool is_rotation(const Eigen::Matrix3d& matrix) {
  return (matrix * matrix.transpose()).isIdentity(1e-6) && matrix.determinant() > 0;
}

/// Comparisons are written so that a NaN is wrong.
struct FindFlaw {
  static constexpr std::string_view kSize = "has a size that is not positive";
  static constexpr std::string_view kPose = "is posed by a matrix that is no rotation";

  std::string_view operator()(const Sphere& s) const { return s.radius > 0 ? "" : kSize; }
  std::string_view operator()(const Capsule& s) const { return s.radius > 0 ? "" : kSize; }
  std::string_view operator()(const Box& s) const {
    if (!(s.half_extents.array() > 0).all()) return kSize;
    return is_rotation(s.pose.rotation) ? "" : kPose;
  }
  std::string_view operator()(const Cylinder& s) const {
    if (!(s.radius > 0 && s.length > 0)) return kSize;
    return is_rotation(s.pose.rotation) ? "" : kPose;
  }
  template <class Part>
  std::string_view operator()(const CompoundShape<Part>& s) const {
    constexpr double kLeastRadius = std::is_same_v<Part, CloudPoint> ? 1e-9 : 0;
    if (!s.parts || s.parts->list().empty()) return "has no parts";
    if (!(s.radius >= kLeastRadius)) return "has a radius that is not positive";
    if (PartsAccess::bounds(*s.parts).is_empty()) {
      return "has a part that is not finite or has a negative size";
    }
    return is_rotation(s.pose.rotation) ? "" : kPose;
  }
};

}  // namespace

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

}  // namespace mneme::internal
