// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/as_index.h"
#include "path/rest_to_rest.h"
#include "path/waypoints.h"

#include <algorithm>
#include <cmath>

namespace mneme::internal {
namespace {

std::vector<float> paces_by_velocity(const Robot& robot) {
  constexpr double kSlowest = 1e-3;  // a limit of 0 means that a joint does not move by itself
  std::vector<float> paces;
  for (int i = 0; i < robot.joint_count(); ++i) {
    paces.push_back(static_cast<float>(1 / std::max(robot.group_joint(i).velocity, kSlowest)));
  }
  return paces;
}

}  // namespace

std::vector<float> paces_of(const Robot& robot, const Path& path, const RateLimits* limits) {
  constexpr double kLeastTime = 1e-3;  // seconds, of a path that returns to its start
  if (limits == nullptr || path.empty()) return paces_by_velocity(robot);
  const auto joints = as_index(robot.joint_count());
  const Configuration end = robot.turned_near(path.back(), path.front());
  double time_s = kLeastTime;
  for (std::size_t j = 0; j < joints; ++j) {
    const double distance = std::abs(end[j] - path.front()[j]);
    time_s = std::max(time_s, rest_to_rest(*limits, j).duration_s(distance));
  }
  std::vector<float> paces;
  for (std::size_t j = 0; j < joints; ++j) {
    paces.push_back(static_cast<float>(time_s / rest_to_rest(*limits, j).distance(time_s)));
  }
  return paces;
}

}  // namespace mneme::internal
