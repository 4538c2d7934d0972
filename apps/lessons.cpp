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
  const Result<std::vector<std::string>> files = expand(pattern);
  if (!files) return files;
  std::vector<std::string> problems;
  for (const std::string& file : *files) {
    if (!file.ends_with(".json")) {
      problems.push_back(file);
      continue;
    }
    const Result<std::vector<std::string>> names = list_problems(file);
    if (!names) return names;
    for (const std::string& name : *names) problems.push_back(file + "#" + name);
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
  const Result<Workspace> workspace = load_workspace(where, overrides);
  if (!workspace) return tl::unexpected(workspace.error());
  const Result<void> fits = check_robot(where, *workspace, robot);
  if (!fits) return fits;
  const Result<Scene> scene = in_root_frame(workspace->framed, robot);
  if (!scene) return tl::unexpected(scene.error());
  const auto found = decompose({robot, *scene}, settings);
  if (!found) return tl::unexpected(found.error());
  for (const LocalPrimitive& primitive : *found) {
    if (std::ranges::find(keys, primitive.key) == keys.end()) keys.push_back(primitive.key);
  }
  return {};
}

Result<std::vector<std::string>> all_problems(const LessonSource& source) {
  std::vector<std::string> all;
  for (const std::string& pattern : source.scenes) {
    const Result<std::vector<std::string>> problems = expand_problems(pattern);
    if (!problems) return problems;
    all.insert(all.end(), problems->begin(), problems->end());
  }
  return all;
}

Result<Robot> choose_robot(const LessonSource& source, const ProblemOptions& overrides,
                           const std::vector<std::string>& problems) {
  if (!problems.empty()) {
    const Result<Workspace> first = load_workspace(problems.front(), overrides);
    if (!first) return tl::unexpected(first.error());
    if (first->problem) return first->problem->robot;
  }
  return load_named_robot(source.robot, source.robot_options);
}

}  // namespace

Result<PrimitiveLesson> load_primitive_lesson(const LessonSource& source) {
  const Result<ProblemOptions> overrides = problem_options(source.robot, source.robot_options);
  if (!overrides) return tl::unexpected(overrides.error());
  const Result<std::vector<std::string>> problems = all_problems(source);
  if (!problems) return tl::unexpected(problems.error());
  const Result<Robot> robot = choose_robot(source, *overrides, *problems);
  if (!robot) return tl::unexpected(robot.error());
  if (!problems->empty()) {
    const auto kind = choose_kind(*robot, source.memory);
    if (!kind) return tl::unexpected(kind.error());
    if (!(*kind)->can_learn_primitives()) {
      return fail(
          ErrorCode::unsupported,
          fmt::format("--scenes: memory of the kind '{}' learns from solved problems alone; "
                      "give --problems",
                      (*kind)->name));
    }
  }
  PrimitiveLesson lesson{*robot, {}};
  for (const std::string& problem : *problems) {
    const Result<void> added =
        append_primitives(problem, *robot, *overrides, source.memory, lesson.keys);
    if (!added) return tl::unexpected(added.error());
  }
  return lesson;
}

}  // namespace mneme::app
