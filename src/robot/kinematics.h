// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// How joints move links: forward kinematics over a sorted tree, and what moves what.
#pragma once

#include "mneme/robot.h"

#include <optional>
#include <span>
#include <vector>

namespace mneme::internal {

/// Radians or metres beyond a limit that are taken for a rounding error.
inline constexpr double kLimitTolerance = 1e-5;

/// Pose of the joint's child in its frame at `value`.
[[nodiscard]] Transform joint_motion(const Joint& joint, double value);

/// Values of all joints: `group[i]` takes the value `q[i]`; other joints follow or stand at their
/// fixed values.
[[nodiscard]] std::vector<double> joint_values(std::span<const Joint> joints,
                                               std::span<const int> group,
                                               std::span<const double> q);

/// Poses of all links in the root link's frame, with the joints at joint_values(). Links and
/// joints are in tree order.
[[nodiscard]] std::vector<Transform> forward_kinematics(std::span<const Joint> joints,
                                                        std::span<const int> group,
                                                        std::span<const double> q);

/// Per joint whether joints of `group` move it, itself or by way of one that it follows.
[[nodiscard]] std::vector<bool> find_moving(std::span<const Joint> joints,
                                            std::span<const int> group);
/// Per link whether a joint of the group moves it, itself or by a joint that follows one.
[[nodiscard]] std::vector<bool> find_moving_links(const Robot& robot);

/// Joints that carry the link, from it to the root.
[[nodiscard]] std::vector<int> joints_to(const Robot& robot, int link);

/// A joint's value is `rate` times that of a joint of the group, plus `offset`.
struct Drive {
  int joint = 0;  ///< of the group
  double rate = 1, offset = 0;
};
/// Nothing if the joint stays at its fixed value, as one does that follows another at rate 0.
[[nodiscard]] std::optional<Drive> find_drive(const Robot& robot, int joint);

/// True if all joints of the group, and all that follow them, turn about the z axis of a frame
/// whose z axis is parallel to the root's, and all shapes are centred in z = 0; to within 1e-9. It
/// is enough to look at one configuration, since such joints keep z.
[[nodiscard]] bool moves_in_plane(std::span<const Link> links, std::span<const Joint> joints,
                                  std::span<const int> group);

}  // namespace mneme::internal
