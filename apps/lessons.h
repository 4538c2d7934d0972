// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The primitives of scenes and problems, for `mneme learn`.
#pragma once

#include "mneme/memory.h"
#include "mneme/robot.h"

#include "options.h"

#include <string>
#include <vector>

namespace mneme::app {

/// The sources of primitives on the command line.
struct LessonSource {
  std::string robot;
  RobotOptions robot_options;
  std::vector<std::string> scenes;  ///< patterns of files, or FILE.json#NAME
  MemorySettings memory;
};

/// Primitives to learn, and their robot: the one of the problems, if there are any.
struct PrimitiveLesson {
  Robot robot;
  std::vector<PrimitiveKey> keys;  ///< no two alike
};

[[nodiscard]] Result<PrimitiveLesson> load_primitive_lesson(const LessonSource& source);

}  // namespace mneme::app
