// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmark/comparisons.h"

#include "report/markup.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace mneme::internal {
namespace {

struct Counterpart {
  const char* native;
  const char* ompl;
};
constexpr std::array<Counterpart, 3> kCounterparts = {
    {{"rrt_connect", "ompl:RRTConnect"}, {"rrt", "ompl:RRT"}, {"prm", "ompl:PRM"}}};

const Series* find_series(const Panel& panel, const std::string& planner,
                          const std::string& sampler, const std::string* setting) {
  const auto found = std::ranges::find_if(panel.series, [&](const Series& s) {
    return s.planner == planner && s.sampler == sampler &&
           (setting == nullptr || s.setting == *setting);
  });
  return found == panel.series.end() ? nullptr : &*found;
}

const Series* find_baseline(const Panel& panel, const Series& series, const std::string& baseline) {
  if (series.sampler == baseline) return nullptr;
  const Series* same = find_series(panel, series.planner, baseline, &series.setting);
  return same != nullptr ? same : find_series(panel, series.planner, baseline, nullptr);
}

const Series* find_ompl(const Panel& panel, const Series& series) {
  for (const Counterpart& counterpart : kCounterparts) {
    if (series.planner != counterpart.native) continue;
    return find_series(panel, counterpart.ompl, series.sampler, &series.setting);
  }
  return nullptr;
}

std::string format_number(double ratio) {
  if (ratio >= 100) return fmt::format("{:.0f}", ratio);
  if (ratio >= 10) return fmt::format("{:.1f}", ratio);
  return ratio >= 0.1 ? fmt::format("{:.2f}", ratio) : fmt::format("{:.2g}", ratio);
}

}  // namespace

std::vector<Comparison> compare_series(const Panel& panel, const std::string& baseline) {
  std::vector<Comparison> comparisons;
  const auto add = [&](const char* kind, const Series& other, const Series* reference) {
    if (reference == nullptr || reference == &other) return;
    const PairedRatio ratio = compare_runs(reference->rows, other.rows);
    if (ratio.pairs > 0) comparisons.push_back({kind, &other, reference, ratio});
  };
  for (const Series& s : panel.series) add("sampler", s, find_baseline(panel, s, baseline));
  for (const Series& s : panel.series) {
    add("setting", s, find_series(panel, s.planner, s.sampler, nullptr));
  }
  for (const Series& s : panel.series) add("planner", s, find_ompl(panel, s));
  return comparisons;
}

std::string format_ratio(const TimeRatio& ratio) {
  if (ratio.is_at_least && ratio.is_at_most) return "open";
  const char* mark = ratio.is_at_least ? "≥ " : ratio.is_at_most ? "≤ " : "";
  return fmt::format("{}{} ({} to {})", mark, format_number(ratio.value), format_number(ratio.low),
                     format_number(ratio.high));
}

std::string series_name(const Series& series) {
  return single_line(series.planner) + ", " + short_label(series);
}

}  // namespace mneme::internal
