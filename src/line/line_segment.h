// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The poses of a line.
#pragma once

#include "mneme/geometry.h"

#include "goal/link_chain.h"

namespace mneme::internal {

/// Poses in the root link's frame, at shares of the line from 0 to 1.
class LineSegment {
 public:
  LineSegment(const Transform& begin, const Transform& end)
      : begin_(begin), twist_(difference(begin, end)), angle_(twist_.tail<3>().norm()) {
    if (angle_ > 0) axis_ = twist_.tail<3>() / angle_;
  }

  [[nodiscard]] Transform at(double s) const {
    Transform pose = begin_;
    pose.translation += s * twist_.head<3>();
    if (angle_ > 0) pose.rotation = rotation_about(axis_, s * angle_) * begin_.rotation;
    return pose;
  }
  [[nodiscard]] double length() const { return twist_.head<3>().norm(); }  ///< metres
  [[nodiscard]] double angle() const { return angle_; }                    ///< radians
  /// Metres; a radian counts as a quarter of a metre.
  [[nodiscard]] double size() const { return length() + 0.25 * angle_; }

 private:
  Transform begin_;
  Twist twist_;
  double angle_;
  Vec3 axis_ = Vec3::UnitZ();
};

}  // namespace mneme::internal
