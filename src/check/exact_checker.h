// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Contact in double precision for many states of one robot in one scene.
#pragma once

#include <span>
#include <vector>

#include "mneme/robot.h"
#include "mneme/scene.h"

namespace mneme::internal {

/// Says what the exact distances of geometry.h say, but leaves out what bounding spheres keep
/// apart. Const and parallel-safe; robot and scene must outlive it.
class ExactChecker {
 public:
  ExactChecker(const Robot& robot, const Scene& scene);

  /// True if nothing touches at `q`, which has joint_count() values.
  [[nodiscard]] bool is_free(std::span<const double> q) const;

 private:
  [[nodiscard]] bool touches_obstacle(std::size_t link, const Transform& X_WL) const;
  [[nodiscard]] bool touch(std::size_t a, const Transform& X_WA, std::size_t b,
                           const Transform& X_WB) const;

  const Robot& robot_;
  const Scene& scene_;
  std::vector<std::vector<Capsule>> links_;  ///< their shapes; a sphere is a segment of length zero
  std::vector<Sphere> link_bounds_;
  std::vector<std::vector<Sphere>> shape_bounds_;  ///< of the obstacles
};

}  // namespace mneme::internal
