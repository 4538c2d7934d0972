// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Where a link may be at all.
#pragma once

#include "mneme/robot.h"

#include "base/as_index.h"
#include "robot/kinematics.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace mneme::internal {

/// A ball that contains the origin of a link in every configuration.
class Reach {
 public:
  Reach(const Robot& robot, const std::string& link) {
    const Joint* first = nullptr;
    for (const int i : joints_to(robot, *robot.find_link(link))) {
      first = &robot.joints()[as_index(i)];
      radius_ += first->origin.translation.norm();
      if (first->type == JointType::prismatic) {
        radius_ += std::max(std::abs(first->lower), std::abs(first->upper));
      }
    }
    if (first == nullptr || first->type == JointType::prismatic) return;
    // The origin of the first joint itself does not move.
    centre_ = first->origin.translation;
    radius_ -= centre_.norm();
  }
  [[nodiscard]] bool contains(const Transform& pose) const {
    return (pose.translation - centre_).norm() <= radius_ + 1e-6;
  }

 private:
  Vec3 centre_ = Vec3::Zero();
  double radius_ = 0;
};

}  // namespace mneme::internal
