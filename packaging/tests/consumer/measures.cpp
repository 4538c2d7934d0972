// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Uses a little of mneme::view and mneme::bench.
#include <cstdio>

#include "mneme/baselines.h"
#include "mneme/benchmark.h"
#include "mneme/report.h"

int main() {
  const auto file = mneme::find_scene("planar/threaded_b2.yaml");
  if (!file) return std::puts(file.error().message.c_str()), 1;
  const auto problem = mneme::load_problem(*file);
  if (!problem) return std::puts(problem.error().message.c_str()), 1;
  mneme::add_baseline_samplers();
  mneme::SolveSettings settings;
  settings.sampler = "pooled";
  const auto result = mneme::solve(*problem, nullptr, settings);
  if (!result) return std::puts(result.error().message.c_str()), 1;
  const auto picture = mneme::to_svg(mneme::make_picture(*problem, *result));
  if (!picture) return std::puts(picture.error().message.c_str()), 1;
  std::puts(mneme::csv_header().c_str());
  return 0;
}
