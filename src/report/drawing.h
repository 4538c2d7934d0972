// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What a picture shows, in metres, before it is laid out.
#pragma once

#include <string>
#include <vector>

#include "mneme/report.h"
#include "report/arms.h"
#include "report/obstacle_outline.h"
#include "report/planar_view.h"

namespace mneme::internal {

/// A primitive in the rectangle around its two circles.
struct FramedPrimitive {
  std::vector<Point> corners;  ///< counter-clockwise
  std::string label;  ///< how many matches there are, and the similarity error of the nearest
};

struct RememberedArm {
  Origin origin = 0;  ///< index of the primitive
  Arm arm;
};

struct Drawing {
  std::vector<Outline> obstacles;
  std::vector<FramedPrimitive> primitives;
  std::vector<RememberedArm> memories;
  std::vector<Arm> fan;          ///< along the path, from start to goal, without both
  std::vector<Point> tip_trace;  ///< of the end of the last link along the path
  Arm start;
  std::vector<Arm> goals;
  Point base;
  double reach = 0;  ///< no point of the robot is farther from the base
};

/// Errors: unsupported if the robot is not planar; invalid if a configuration, a primitive or the
/// mixture does not fit it.
[[nodiscard]] Result<Drawing> make_drawing(const PlanarPicture& picture);

/// Bounds of all that is drawn, obstacles only as far as the arm reaches.
[[nodiscard]] Bounds bounds_of(const Drawing& drawing);

}  // namespace mneme::internal
