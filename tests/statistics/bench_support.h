// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Runs of a small benchmark, made by hand.
#pragma once

#include "mneme/statistics.h"

#include "report/report_support.h"

namespace mneme::test {

inline BenchmarkRow run(double planning_time_s, bool is_solved = true) {
  BenchmarkRow row;
  row.problem = "S1";
  row.planner = "rrt_connect";
  row.sampler = "gl";
  row.is_solved = is_solved;
  row.status = is_solved ? PlanStatus::solved : PlanStatus::timeout;
  row.is_path_valid = is_solved;
  row.planning_time_s = planning_time_s;
  return row;
}

/// Three planners, three samplers and 20 seeds on one set; times depend on all of them, every
/// seventh run of the sampler "uniform" is a time-out at 20 s, and one path is bad.
inline std::vector<BenchmarkRow> suite_rows() {
  std::vector<BenchmarkRow> rows;
  Rng rng(7);
  for (const char* planner : {"rrt_connect", "prm", "rrt"}) {
    for (const char* sampler : {"gl", "uniform", "halton"}) {
      for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const bool is_slow = std::string(sampler) == "uniform";
        const bool is_solved = !(is_slow && seed % 7 == 0);
        const double time_s = (is_slow ? 0.2 : 0.002) * (1 + 3 * rng.uniform());
        BenchmarkRow row = run(is_solved ? time_s : 20, is_solved);
        row.set = "scenario";
        row.planner = planner;
        row.sampler = sampler;
        row.seed = seed;
        row.timeout_s = 20;
        row.total_time_s = row.planning_time_s;
        row.setting = "tuned";
        row.settings = "range=0.5 memory=grid";
        row.machine = "a machine";
        row.version = "mneme 1 with g++ 12";
        row.isa = "avx2";
        row.started = "2026-01-31T12:00:00Z";
        rows.push_back(row);
      }
    }
  }
  rows[45].is_path_valid = false;
  return rows;
}

}  // namespace mneme::test
