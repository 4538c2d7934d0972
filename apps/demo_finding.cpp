// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "demo_finding.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mneme::app {
namespace {

/// Medians whose ratio is less are reported as equal.
constexpr double kNoGain = 1.1;

/// Runs of one planner with one sampler.
struct Runs {
  std::vector<double> times_s;  ///< infinite of those without a path

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
  const double memory_ms = 1e3 * median(memory.times_s), uniform_ms = 1e3 * median(uniform.times_s);
  if (std::isfinite(memory_ms) && std::isfinite(uniform_ms)) {
    return fmt::format("{}: {}", planner, compare_times(uniform_ms, memory_ms));
  }
  const std::string solved = fmt::format("{}: solves {} of {} runs with memory", planner,
                                         memory.solved(), memory.times_s.size());
  const std::string times = std::isfinite(memory_ms) ? fmt::format(" ({:.2g} ms)", memory_ms) : "";
  return fmt::format("{}{}, {} of {} without", solved, times, uniform.solved(),
                     uniform.times_s.size());
}

}  // namespace

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

std::string compare_times(double without_ms, double with_ms) {
  const double factor = without_ms / with_ms;
  if (std::abs(std::log(factor)) < std::log(kNoGain)) {
    return fmt::format("memory gains nothing ({:.2g} ms with and {:.2g} ms without)", with_ms,
                       without_ms);
  }
  return fmt::format("{:.2g} ms with memory instead of {:.2g} ms, {:.2g} times {}", with_ms,
                     without_ms, std::max(factor, 1 / factor), factor > 1 ? "faster" : "slower");
}

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
  return fmt::format("A planar arm in a gap between two circles, median planning times. {}.\n\n",
                     fmt::join(parts, "; "));
}

}  // namespace mneme::app
