// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "plan_files.h"

#include <algorithm>

#include <fmt/format.h>

#include "console.h"
#include "output_file.h"

namespace mneme::app {
namespace {

bool can_draw(const Problem& problem) {
  if (problem.robot.describe_violation(problem.start, "start")) return false;
  return std::none_of(problem.goals.begin(), problem.goals.end(), [&](const Configuration& goal) {
    return problem.robot.describe_violation(goal, "goal").has_value();
  });
}

Result<void> write_picture(const std::string& path, const Problem& problem,
                           const SolveResult& result) {
  PlanarPicture picture;
  picture.problem = &problem;
  picture.gl = &result.gl;
  picture.path = result.plan.path;
  picture.title =
      fmt::format("{}: {} with sampler {}, {} in {:.2f} ms", problem.name, result.planner,
                  result.sampler, to_string(result.plan.status), 1e3 * result.planning_time_s);
  if (!problem.robot.is_planar()) {
    return fail(ErrorCode::unsupported,
                fmt::format("'{}' was not written: robot {} is not planar, which --svg is for; "
                            "--view shows any robot",
                            path, problem.robot.name()));
  }
  return to_svg(picture).and_then([&](const std::string& svg) { return write_file(path, svg); });
}

Result<void> write_trace_and_page(const PlanFiles& files, const Problem& problem,
                                  const SolveResult& result, const PlanRecorder& recorder,
                                  double load_time_s) {
  const Result<PlanTrace> trace = make_trace(problem, result, &recorder, load_time_s);
  if (!trace) return tl::unexpected(trace.error());
  const std::string json = to_json(*trace);
  if (!files.trace.empty()) {
    if (auto written = write_file(files.trace, json + "\n"); !written) return written;
  }
  if (files.view.empty()) return {};
  return to_page(json, files.view).and_then([&](const std::string& page) {
    return write_file(files.view, page);
  });
}

}  // namespace

Result<void> write_plan_files(const PlanFiles& files, const Problem& problem,
                              const SolveResult& result, const PlanRecorder& recorder,
                              double load_time_s) {
  if (!can_draw(problem)) {
    for (const std::string& path : {files.svg, files.view, files.trace}) {
      if (path.empty()) continue;
      print_note(fmt::format("'{}' was not written: start or goal is no configuration", path));
    }
    return {};
  }
  Result<void> written;
  if (files.needs_recorder()) {
    written = write_trace_and_page(files, problem, result, recorder, load_time_s);
  }
  if (files.svg.empty()) return written;
  const Result<void> drawn = write_picture(files.svg, problem, result);
  return written ? drawn : written;
}

}  // namespace mneme::app
