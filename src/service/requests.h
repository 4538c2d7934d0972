// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Requests, parsed from their JSON bodies (docs/service.md). No key of a body names a file.
#pragma once

#include "mneme/pipeline.h"
#include "mneme/service.h"
#include "mneme/task.h"

#include "service/scene_store.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// Robot, scenes and limits for reading requests.
struct RequestContext {
  const Robot& robot;
  const SceneStore& scenes;
  const ServiceSettings& limits;  ///< with `threads` above 0
  bool has_memory = false;
};

struct PlanRequest {
  Problem problem;
  SolveSettings settings;
  std::optional<TrajectorySettings> timing;  ///< of the trajectory, if one is wanted
  bool wants_clearance = false;
  bool wants_trace = false;
  bool may_remember = true;
};
/// Reads the body of a request to plan. Errors: as for problem files; robot or joints differ from
/// the service's; an unknown scene or setting; a limit is exceeded. `query`: of the URL; its keys
/// `trajectory` and `dt` stand for those of the body.
[[nodiscard]] Result<PlanRequest> read_plan_request(std::string_view body, std::string_view query,
                                                    const RequestContext& context);

struct TaskRequest {
  Task task;
  TaskSettings settings;
  std::optional<TrajectorySettings> timing;  ///< of the trajectory, if one is wanted
  bool may_remember = true;
};
/// Reads the body of a request to plan a task: as a request to plan, with `stages` in place of
/// goals. Errors: as of read_plan_request() and check_task().
[[nodiscard]] Result<TaskRequest> read_task_request(std::string_view body, std::string_view query,
                                                    const RequestContext& context);

struct CheckRequest {
  Problem problem;  ///< robot and scene
  std::vector<Configuration> configurations;
  double margin = 0;
};
[[nodiscard]] Result<CheckRequest> read_check_request(std::string_view body,
                                                      const RequestContext& context);

struct IkRequest {
  Problem problem;  ///< pose goals, and the start of the search
  IkSettings settings;
  double margin = 0;
};
[[nodiscard]] Result<IkRequest> read_ik_request(std::string_view body,
                                                const RequestContext& context);

/// Reads a scene that is kept under the name `id`.
[[nodiscard]] Result<Scene> read_scene_request(std::string_view body, const std::string& id,
                                               const RequestContext& context);
/// Returns `scene` after the removals and additions of the body.
[[nodiscard]] Result<Scene> edit_scene(std::string_view body, const Scene& scene,
                                       const RequestContext& context);

}  // namespace mneme::internal
