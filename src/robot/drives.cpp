// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/drives.h"

#include "base/as_index.h"

#include <algorithm>

namespace mneme::internal {

std::vector<int> joints_to(const Robot& robot, int link) {
  std::vector<int> joints;
  for (int i = robot.links()[as_index(link)].parent_joint; i >= 0;) {
    joints.push_back(i);
    i = robot.links()[as_index(robot.joints()[as_index(i)].parent_link)].parent_joint;
  }
  return joints;
}

std::optional<Drive> find_drive(const Robot& robot, int joint) {
  const Mimic drive = robot.joints()[as_index(joint)].mimic.value_or(Mimic{joint, 1, 0});
  const auto found = std::ranges::find(robot.group(), drive.joint);
  if (found == robot.group().end() || drive.multiplier == 0) return std::nullopt;
  return Drive{static_cast<int>(found - robot.group().begin()), drive.multiplier, drive.offset};
}

}  // namespace mneme::internal
