// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// How far a robot is from the obstacles of a scene.
#pragma once

#include <span>
#include <vector>

#include "mneme/robot.h"
#include "mneme/scene.h"

namespace mneme::internal {

struct Clearance {
  /// Metres between surfaces; in contact negative, by at most the radius of the link's shape;
  /// infinite without obstacles.
  double distance = 0;
  int link = -1;      ///< index into the robot's links
  int obstacle = -1;  ///< index into the scene
};

/// Exact distances in double precision for many states. Const and parallel-safe; robot and scene
/// must outlive it.
class ClearanceMeter {
 public:
  ClearanceMeter(const Robot& robot, const Scene& scene);

  /// Of the nearest pair of an obstacle and a link that the group moves. `poses` are those of all
  /// links.
  [[nodiscard]] Clearance measure(std::span<const Transform> poses) const;

 private:
  struct Body {
    int link = 0;
    Capsule shape;  ///< in the link's frame; a sphere is a segment of length zero
  };
  struct Part {
    int obstacle = 0;
    const Shape* shape = nullptr;
    Sphere bound;
  };
  std::vector<Body> bodies_;
  std::vector<Part> parts_;
};

}  // namespace mneme::internal
