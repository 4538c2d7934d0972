// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/xml_text.h"

#include <cmath>

#include <fmt/format.h>

namespace mneme::internal {
namespace {

/// Roll, pitch and yaw. Roll is taken from what yaw leaves over, so that their sum is right where
/// the pitch is near a quarter turn and either alone is arbitrary.
Vec3 rpy_of(const Eigen::Matrix3d& r) {
  const double yaw = std::atan2(r(1, 0), r(0, 0));
  const double pitch = std::atan2(-r(2, 0), std::hypot(r(0, 0), r(1, 0)));
  const double c = std::cos(yaw), s = std::sin(yaw);
  const double roll = std::atan2(s * r(0, 2) - c * r(1, 2), c * r(1, 1) - s * r(0, 1));
  return {roll, pitch, yaw};
}

}  // namespace

std::string xml_escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string xml_vector(const Vec3& v) {
  // Adding zero makes a zero positive.
  return fmt::format("{} {} {}", v.x() + 0.0, v.y() + 0.0, v.z() + 0.0);
}

std::string xml_origin(const Transform& pose) {
  std::string attributes;
  if (!pose.translation.isZero(0)) {
    attributes += fmt::format(" xyz=\"{}\"", xml_vector(pose.translation));
  }
  const Vec3 rpy = rpy_of(pose.rotation);
  if (!rpy.isZero(0)) attributes += fmt::format(" rpy=\"{}\"", xml_vector(rpy));
  return attributes.empty() ? "" : "<origin" + attributes + "/>";
}

}  // namespace mneme::internal
