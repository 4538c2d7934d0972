// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "lessons.h"

#include "console.h"
#include "inputs.h"

#include <fmt/format.h>

#include <glob.h>
#include <algorithm>

namespace mneme::app {
namespace {

/// The files that a pattern stands for; a problem's "#NAME" is no part of the pattern.
Result<std::vector<std::string>> expand(const std::string& pattern) {
  const std::size_t json = pattern.find(".json#");
  const std::size_t end = json == std::string::npos ? pattern.size() : json + 5;
  glob_t found = {};
  const int status = glob(pattern.substr(0, end).c_str(), 0, nullptr, &found);
  std::vector<std::string> files;
  for (std::size_t i = 0; i < found.gl_pathc; ++i) {
    files.push_back(found.gl_pathv[i] + pattern.substr(end));
  }
  globfree(&found);
  if (status == 0) return files;
  return fail(ErrorCode::io, fmt::format("no file matches '{}'", pattern));
}

/// The scenes and problems that a pattern stands for: all problems of a compact file without
/// "#NAME".
Result<std::vector<std::string>> expand_problems(const std::string& pattern) {
  const std::vector<std::string> files = MNEME_TRY(expand(pattern));
  std::vector<std::string> problems;
  for (const std::string& file : files) {
    if (!file.ends_with(".json")) {
      problems.push_back(file);
      continue;
    }
    const std::vector<std::string> names = MNEME_TRY(list_problems(file));
    for (const std::string& name : names) problems.push_back(file + "#" + name);
  }
  return problems;
}

/// A problem says itself which joints it plans for and where the others stand.
Result<void> check_robot(const std::string& where, const Workspace& workspace, const Robot& robot) {
  if (!workspace.problem || workspace.problem->robot.hash() == robot.hash()) return {};
  return fail(ErrorCode::invalid,
              fmt::format("'{}': its robot '{}' has other joints to plan for, fixed values or "
                          "shapes than robot '{}' of the scenes before it",
                          where, workspace.problem->robot.name(), robot.name()));
}

Result<void> append_primitives(const std::string& where, const Robot& robot,
                               const ProblemOptions& overrides, const MemorySettings& settings,
                               std::vector<PrimitiveKey>& keys) {
  const Workspace workspace = MNEME_TRY(load_workspace(where, overrides));
  MNEME_TRY(check_robot(where, workspace, robot));
  const Scene scene = MNEME_TRY(in_root_frame(workspace.framed, robot));
  const auto found = MNEME_TRY(decompose({robot, scene}, settings));
  for (const LocalPrimitive& primitive : found) {
    if (std::ranges::find(keys, primitive.key) == keys.end()) keys.push_back(primitive.key);
  }
  return {};
}

Result<std::vector<std::string>> all_problems(const LessonSource& source) {
  std::vector<std::string> all;
  for (const std::string& pattern : source.scenes) {
    const std::vector<std::string> problems = MNEME_TRY(expand_problems(pattern));
    all.insert(all.end(), problems.begin(), problems.end());
  }
  return all;
}

Result<Robot> choose_robot(const LessonSource& source, const ProblemOptions& overrides,
                           const std::vector<std::string>& problems) {
  if (!problems.empty()) {
    const Workspace first = MNEME_TRY(load_workspace(problems.front(), overrides));
    if (first.problem) return first.problem->robot;
  }
  return load_named_robot(source.robot, source.robot_options);
}

}  // namespace

Result<PrimitiveLesson> load_primitive_lesson(const LessonSource& source) {
  const ProblemOptions overrides = MNEME_TRY(problem_options(source.robot, source.robot_options));
  const std::vector<std::string> problems = MNEME_TRY(all_problems(source));
  const Robot robot = MNEME_TRY(choose_robot(source, overrides, problems));
  if (!problems.empty()) {
    const MemoryKind* kind = MNEME_TRY(choose_kind(robot, source.memory));
    if (!kind->can_learn_primitives()) {
      return fail(
          ErrorCode::unsupported,
          fmt::format("--scenes: memory of the kind '{}' learns from solved problems alone; "
                      "give --problems",
                      kind->name));
    }
  }
  PrimitiveLesson lesson{robot, {}};
  for (const std::string& problem : problems) {
    MNEME_TRY(append_primitives(problem, robot, overrides, source.memory, lesson.keys));
  }
  return lesson;
}

}  // namespace mneme::app
