// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The parts of a trace's page: a robot reduced to points, and the page of the viewer.
#pragma once

#include "mneme/robot.h"

#include <span>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// The chain of the planning group. Const and parallel-safe.
class Skeleton {
 public:
  explicit Skeleton(const Robot& robot);

  /// The end effector, given the poses of all links: the middle of what is farthest from the last
  /// joint among all that it carries.
  [[nodiscard]] Vec3 tip(std::span<const Transform> poses) const;
  /// The origins of the links that the group's joints carry, in its order, then the tip.
  [[nodiscard]] std::vector<Vec3> points(std::span<const double> q) const;

 private:
  Robot robot_;
  std::size_t tip_link_ = 0;
  Vec3 tip_in_link_ = Vec3::Zero();
};

/// viewer/dist/viewer.html, as the build puts it into the library: the page without a trace.
[[nodiscard]] std::string_view viewer_page();

}  // namespace mneme::internal
