// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What problem files and compact files have in common.
#pragma once

#include <string>

#include "mneme/problem.h"
#include "scene/input.h"

namespace mneme::internal {

struct ProblemInput {
  Input header;   ///< has the keys robot, joints, fixed_joints and frame
  Input problem;  ///< has the keys start and goal or goals; may be the same map
  std::string name;
  std::string directory;  ///< of the file
  Scene scene;            ///< in the frame that the header names
};

/// The directory that paths in the file `path` are relative to.
[[nodiscard]] std::string directory_of(const std::string& path);

/// The key `scene` of the problem file at `path`: a scene, or the path of a scene file. Throws
/// InputFailure.
[[nodiscard]] Scene read_scene_of_problem(const Input& problem, const std::string& path);

/// Throws InputFailure.
[[nodiscard]] Problem read_problem(const ProblemInput& input, const ProblemOptions& options);

}  // namespace mneme::internal
