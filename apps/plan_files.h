// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The files that `mneme plan` writes for people: a picture, a page, a trace.
#pragma once

#include <string>

#include "mneme/report.h"

namespace mneme::app {

/// Paths of what is wanted; empty for what is not.
struct PlanFiles {
  std::string svg;
  std::string view;
  std::string trace;

  /// True if the planner must be watched.
  [[nodiscard]] bool needs_recorder() const { return !view.empty() || !trace.empty(); }
};

/// Writes what is wanted. Without a usable start or goal there is nothing to draw: a note says so.
[[nodiscard]] Result<void> write_plan_files(const PlanFiles& files, const Problem& problem,
                                            const SolveResult& result, const PlanRecorder& recorder,
                                            double load_time_s);

}  // namespace mneme::app
