// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A traced plan made by hand.
#pragma once

#include "mneme/report.h"

#include "report/report_support.h"

namespace mneme::test {

/// A plan through the gap of report_support.h, with memory and a few samples and edges.
struct TracedPlan {
  Problem problem = gap_problem();
  Experience experience;
  SolveResult result;
  PlanRecorder recorder;

  explicit TracedPlan(int components = 5) {
    experience.sampler().joint_count = 3;
    experience.sampler().means.assign(6, 0.0F);
    result.plan.status = PlanStatus::solved;
    result.plan.path = {problem.start, {0.5, 0.1, 0}, problem.goals[0]};
    result.planner = "rrt_connect";
    result.sampler = "gl";
    result.planning_time_s = 1;
    result.gl = gap_memory(components);
    for (Match& match : result.gl.primitives[0].matches) {
      match.experience = std::make_shared<const Experience>(experience);
    }
    for (int i = 0; i < 4; ++i)
      recorder.on_sample(std::array{0.1F * static_cast<float>(i), 0.0F, 0.0F}, i < 3 ? -1 : 0);
    recorder.on_edge(std::array{0.0F, 0.0F, 0.0F}, std::array{0.5F, 0.0F, 0.0F}, 0);
    recorder.on_edge(std::array{1.5F, 0.4F, 0.3F}, std::array{1.5F, 0.4F, 0.2F}, 1);
  }

  [[nodiscard]] PlanTrace trace(const TraceSettings& settings = {}) const {
    return require(make_trace(problem, result, &recorder, 0.25, settings));
  }
};

}  // namespace mneme::test
