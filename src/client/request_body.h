// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Problems, scenes and settings as bodies of requests.
#pragma once

#include "mneme/pipeline.h"

#include <nlohmann/json.hpp>

#include <span>
#include <string>

namespace mneme::internal {

/// In the problem's own scene if there is no `scene_id`.
[[nodiscard]] nlohmann::json plan_body(const Problem& problem, const std::string& scene_id,
                                       const SolveSettings& settings);
[[nodiscard]] nlohmann::json ik_body(std::span<const PoseGoal> goals, const Configuration& near,
                                     const Scene& scene, const IkSettings& settings);
[[nodiscard]] nlohmann::json scene_body(const Scene& scene);

}  // namespace mneme::internal
