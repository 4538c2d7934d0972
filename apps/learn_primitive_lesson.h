// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What `mneme learn --scenes` learns: the primitives of scenes and problems.
#pragma once

#include "mneme/learning.h"

#include "options.h"

#include <string>
#include <vector>

namespace mneme::app {

/// Where primitives come from, as the command line says it.
struct LessonSource {
  std::string robot;
  RobotOptions robot_options;
  std::vector<std::string> scenes;  ///< patterns of files, or FILE.json#NAME
  DecomposeSettings decompose;
};

/// What is to be learned, and for which robot: that of the problems, if there are any.
struct PrimitiveLesson {
  Robot robot;
  std::vector<LocalProblem> primitives;  ///< no two with the same key
};

[[nodiscard]] Result<PrimitiveLesson> load_primitive_lesson(const LessonSource& source);

}  // namespace mneme::app
