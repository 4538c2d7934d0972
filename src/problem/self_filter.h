// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Points that a sensor took of the robot itself.
#pragma once

#include "mneme/problem.h"

#include "scene/input.h"

#include <optional>
#include <string>
#include <vector>

namespace mneme::internal {

/// What the options say, otherwise the key `self_filter` of `problem`. Throws InputFailure.
[[nodiscard]] std::optional<double> read_self_filter(const Input& problem,
                                                     const ProblemOptions& options);

/// drop_own_points, if a distance is given and `start` is a configuration: planning refuses any
/// other. Throws InputFailure.
[[nodiscard]] std::vector<std::string> filter_own_points(std::optional<double> distance,
                                                         const Robot& robot,
                                                         const Configuration& start, Scene& scene);

}  // namespace mneme::internal
