// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A robot's moving body as points with radii, and how they move with its joints.
#pragma once

#include "mneme/robot.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace mneme::internal {

/// A ball of the robot's body; a capsule is a row of them.
struct BodyPoint {
  int link = -1;
  Vec3 center = Vec3::Zero();  ///< in the link's frame
  double radius = 0;
  std::vector<int>
      joints;  ///< of the group that move it, as indices into a configuration; root first
};

/// Per link whether a joint of the group moves it; what only the lift of a robot with a turning
/// joint carries, such as a torso or a head, does not count, because no symmetry turns it.
[[nodiscard]] std::vector<bool> arm_links(const Robot& robot);

/// All shapes of arm_links().
[[nodiscard]] std::vector<BodyPoint> body_points(const Robot& robot);

/// d(center) / dq over the whole group, 3 x joint_count(), for links at `poses`, where `center` is
/// in the root's frame. Joints that follow others are taken to stand still.
[[nodiscard]] Eigen::Matrix3Xd jacobian(const Robot& robot, std::span<const Transform> poses,
                                        const BodyPoint& point, const Vec3& center);

}  // namespace mneme::internal
