// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "demo_finding.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace mneme::app {
namespace {

/// Medians whose ratio is less are reported as equal.
constexpr double kNoGain = 1.1;

/// Runs of one planner with one sampler.
struct Runs {
  std::vector<double> times_s;  ///< infinite of those without a path

  [[nodiscard]] double median_s() const {
    std::vector<double> sorted = times_s;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::ranges::nth_element(sorted, middle);
    return *middle;
  }
  [[nodiscard]] auto solved() const {
    return std::ranges::count_if(times_s, [](double time_s) { return std::isfinite(time_s); });
  }
};

Runs runs_of(std::span<const BenchmarkRow> rows, const std::string& planner,
             const std::string& sampler) {
  Runs runs;
  for (const BenchmarkRow& row : rows) {
    if (row.planner != planner || row.sampler != sampler || !row.problem.starts_with("threaded")) {
      continue;
    }
    runs.times_s.push_back(row.is_solved ? row.planning_time_s
                                         : std::numeric_limits<double>::infinity());
  }
  return runs;
}

std::string compare(const std::string& planner, const Runs& memory, const Runs& uniform) {
  const double memory_ms = 1e3 * memory.median_s(), uniform_ms = 1e3 * uniform.median_s();
  if (!std::isfinite(memory_ms)) {
    return fmt::format("{} solves {} of {} runs from memory and {} of {} without", planner,
                       memory.solved(), memory.times_s.size(), uniform.solved(),
                       uniform.times_s.size());
  }
  if (!std::isfinite(uniform_ms)) {
    return fmt::format("{} takes {:.2g} ms from memory and solves {} of {} runs without", planner,
                       memory_ms, uniform.solved(), uniform.times_s.size());
  }
  const double factor = uniform_ms / memory_ms;
  if (std::abs(std::log(factor)) < std::log(kNoGain)) {
    return fmt::format("{} gains nothing from memory ({:.2g} ms with, {:.2g} ms without)", planner,
                       memory_ms, uniform_ms);
  }
  return fmt::format("{} takes {:.2g} ms from memory and {:.2g} ms without, {:.2g} times {}",
                     planner, memory_ms, uniform_ms, std::max(factor, 1 / factor),
                     factor > 1 ? "faster" : "slower");
}

}  // namespace

std::string describe_finding(std::span<const BenchmarkRow> rows) {
  std::vector<std::string> planners, parts;
  for (const BenchmarkRow& row : rows) {
    if (std::ranges::find(planners, row.planner) == planners.end()) planners.push_back(row.planner);
  }
  for (const std::string& planner : planners) {
    const Runs memory = runs_of(rows, planner, "gl"), uniform = runs_of(rows, planner, "uniform");
    if (memory.times_s.empty() || uniform.times_s.empty()) continue;
    parts.push_back(compare(planner, memory, uniform));
  }
  if (parts.empty()) return "";
  return fmt::format("Arms threaded through a gap, median planning times: {}.\n\n",
                     fmt::join(parts, "; "));
}

}  // namespace mneme::app
