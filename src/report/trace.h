// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The parts of a trace's page: a robot reduced to points, and the page of the viewer.
#pragma once

#include "mneme/base.h"
#include "mneme/robot.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// The joints of the planning group as a polyline. Const and parallel-safe.
class Skeleton {
 public:
  explicit Skeleton(const Robot& robot);

  /// Returns the position of the end effector, given the poses of all links: the middle of the
  /// points that are farthest from the last joint and move with it.
  [[nodiscard]] Vec3 tip(std::span<const Transform> poses) const;
  /// Returns the origins of the child links of the group's joints, in its order, then the tip.
  [[nodiscard]] std::vector<Vec3> points(std::span<const double> q) const;

 private:
  Robot robot_;
  std::size_t tip_link_ = 0;
  Vec3 tip_in_link_ = Vec3::Zero();
};

/// Returns the page of the viewer (viewer/dist/viewer.html) without a trace.
[[nodiscard]] std::string_view viewer_page();
/// As to_page(), with more elements of HTML before the trace.
[[nodiscard]] Result<std::string> to_page_with(std::string_view elements, std::string_view json,
                                               const std::string& source,
                                               std::string_view beside = {});

}  // namespace mneme::internal
