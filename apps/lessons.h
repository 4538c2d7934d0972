// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What `mneme learn` learns from scenes and problems: their primitives.
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
  MemorySettings memory;
};

/// What is to be learned, and for which robot: that of the problems, if there are any.
struct PrimitiveLesson {
  Robot robot;
  std::vector<PrimitiveKey> keys;  ///< no two alike
};

[[nodiscard]] Result<PrimitiveLesson> load_primitive_lesson(const LessonSource& source);

}  // namespace mneme::app
