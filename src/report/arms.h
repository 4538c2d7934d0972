// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Arms of a planar robot as lines, and which arms a picture shows.
#pragma once

#include <span>
#include <vector>

#include "mneme/planning.h"
#include "mneme/robot.h"
#include "mneme/sampling.h"
#include "report/svg_writer.h"

namespace mneme::internal {

/// The centre line of links that are joined end to end; metres.
struct ArmLine {
  std::vector<Point> points;
  double radius = 0;  ///< of the thickest link on it
};
using Arm = std::vector<ArmLine>;

/// The capsules of the robot's links at `q`, and its spheres as lines of one point.
[[nodiscard]] Arm arm_at(const Robot& robot, std::span<const double> q);

/// `count` >= 2 configurations at equal distances along `path`, which is not empty; both ends
/// included.
[[nodiscard]] std::vector<Configuration> spread_along(const Robot& robot, const Path& path,
                                                      int count);

/// At most `limit` components, shared as evenly as can be among their origins and spread over each,
/// so that every primitive is seen. In ascending order.
[[nodiscard]] std::vector<int> choose_components(const GaussianMixture& mixture, int limit);

}  // namespace mneme::internal
