// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Problems as MoveIt and MotionBenchMaker keep them: a planning scene and a motion plan request.
#pragma once

#include "mneme/problem.h"

#include "scene/input.h"

#include <optional>
#include <string>

namespace mneme::internal {

/// SCENE and REQUEST of "SCENE.yaml,REQUEST.yaml"; otherwise nothing.
struct MoveitAddress {
  std::string scene;
  std::string request;
};
[[nodiscard]] std::optional<MoveitAddress> split_moveit_address(const std::string& where);

/// The path that MotionBenchMaker gives to the scene of the request at `path`: the same with the
/// last "request" of its name replaced by "scene". Throws InputFailure if there is no "request".
[[nodiscard]] std::string scene_of_request(const Input& request, const std::string& path);

/// Throws InputFailure.
[[nodiscard]] Problem read_moveit_problem(const MoveitAddress& address,
                                          const ProblemOptions& options);

}  // namespace mneme::internal
