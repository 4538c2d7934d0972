// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What clients ask, read from the bodies of their requests (docs/service.md). No key of a body
/// names a file.
#pragma once

#include "mneme/pipeline.h"
#include "mneme/service.h"

#include "service/scene_store.h"

#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// What requests are read against.
struct RequestContext {
  const Robot& robot;
  const SceneStore& scenes;
  const ServiceSettings& limits;  ///< with `threads` above 0
  bool has_memory = false;
};

struct PlanRequest {
  Problem problem;
  SolveSettings settings;
  bool wants_clearance = false;
  bool wants_trace = false;
  bool may_remember = true;
};
/// Errors: as of problem files; a robot or joints that are not those of the service; an unknown
/// scene or setting; what is beyond the limits.
[[nodiscard]] Result<PlanRequest> read_plan_request(std::string_view body,
                                                    const RequestContext& context);

struct CheckRequest {
  Scene scene;
  std::vector<Configuration> configurations;
  double margin = 0;
};
[[nodiscard]] Result<CheckRequest> read_check_request(std::string_view body,
                                                      const RequestContext& context);

struct IkRequest {
  Problem problem;  ///< its goals are poses, its start is where the search begins
  IkSettings settings;
  double margin = 0;
};
[[nodiscard]] Result<IkRequest> read_ik_request(std::string_view body,
                                                const RequestContext& context);

/// A scene that is to be kept under the name `id`.
[[nodiscard]] Result<Scene> read_scene_request(std::string_view body, const std::string& id,
                                               const RequestContext& context);
/// `scene` without the obstacles that the body removes, and with those that it sets.
[[nodiscard]] Result<Scene> edit_scene(std::string_view body, const Scene& scene,
                                       const RequestContext& context);

}  // namespace mneme::internal
