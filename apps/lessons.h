// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What `mneme learn` learns: the primitives of scenes and problems, or problems themselves.
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

/// The problems among `files`, which are files, single problems and directories, that `part` says,
/// see take_part(): all of one robot, and named after their sets too.
[[nodiscard]] Result<std::vector<Problem>> load_problem_lesson(
    const std::vector<std::string>& files, const std::string& part,
    const ProblemOptions& overrides);

}  // namespace mneme::app
