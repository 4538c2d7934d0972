// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Live pages, which request plans: from a service, or from a planner in the page itself.
#pragma once

#include "mneme/base.h"
#include "mneme/problem.h"
#include "mneme/report.h"
#include "mneme/robot.h"
#include "mneme/scene.h"

#include <string>

namespace mneme {

/// The page at `/` of a service, which requests plans from the service.
struct LivePage {
  std::string html;
  /// Point clouds, meshes and octrees of the page's problem, which the service keeps as the scene
  /// kLivePageScene. Requests of the page name that scene.
  Scene kept = {};
};
inline constexpr const char* kLivePageScene = "page";
/// Returns the robot in an empty scene at the first free configuration among the states of its
/// SRDF, the middle of its limits, and random ones.
[[nodiscard]] Problem resting_problem(const Robot& robot, const std::string& robot_path);
/// Returns a live page that begins with `problem`. Its plans keep the constraints and the velocity
/// at the start. They end at rest, because their goals are poses. Errors: as make_trace().
[[nodiscard]] Result<LivePage> make_live_page(Problem problem, bool has_memory,
                                              const TraceSettings& settings = {});

/// The planner as a WebAssembly module: gzip of its script and of its code, as script/wasm writes
/// them.
struct PlannerModule {
  std::string code, wasm;
};
/// Reads the module from wasm/ in one of data_directories(). Error: io, if no directory has it.
[[nodiscard]] Result<PlannerModule> find_planner_module();
/// As make_live_page(), but the page plans in the browser, without a service and memory. Pairs of
/// links that exact geometry decides are not checked there. Errors: as make_trace(); unsupported
/// for attached objects with meshes.
[[nodiscard]] Result<std::string> make_offline_page(Problem problem, const PlannerModule& module,
                                                    const TraceSettings& settings = {});

}  // namespace mneme
