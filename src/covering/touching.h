// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Which pairs of links touch, in exact double precision, many times over.
#pragma once

#include <span>
#include <vector>

#include "mneme/robot.h"

namespace mneme::internal {

/// The shapes of a robot's links where they stand at one configuration after another. The robot
/// must outlive it. Not thread-safe.
class PosedShapes {
 public:
  explicit PosedShapes(const Robot& robot);

  void pose(std::span<const double> q);
  /// True if shapes of the two links overlap.
  [[nodiscard]] bool touch(int first, int second) const;

 private:
  /// Shapes as capsules; a sphere is one whose ends are the same.
  struct Body {
    Sphere bound;
    std::vector<Capsule> shapes;
  };
  std::vector<Body> local_;
  std::vector<Body> posed_;
  const Robot* robot_;
};

}  // namespace mneme::internal
