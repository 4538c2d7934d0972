// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "statistics/panels.h"

#include "mneme/statistics.h"

#include "report/markup.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace mneme::internal {
namespace {

Panel& panel_of(const BenchmarkRow& row, bool by_problem, std::vector<Panel>& panels) {
  std::string name = row.set.empty() ? row.problem : row.set;
  if (by_problem && !row.set.empty() && row.set != row.problem) name += " / " + row.problem;
  const auto found = std::ranges::find(panels, name, &Panel::name);
  if (found != panels.end()) return *found;
  panels.push_back({std::move(name), {}, 0});
  return panels.back();
}

Series& series_of(const BenchmarkRow& row, std::vector<Series>& all) {
  const auto found = std::ranges::find_if(all, [&](const Series& s) {
    return s.planner == row.planner && s.sampler == row.sampler && s.setting == row.setting;
  });
  if (found != all.end()) return *found;
  Series& added = all.emplace_back();
  added.planner = row.planner;
  added.sampler = row.sampler;
  added.setting = row.setting;
  return added;
}

void finish(Series& series) {
  static_cast<SetSummary&>(series) = summarize_each(series.rows).front();
  std::erase_if(series.rows, is_invalid_problem);
  for (const BenchmarkRow& row : series.rows) {
    if (is_success(row)) series.solved_times.push_back(row.planning_time_s);
  }
  std::ranges::sort(series.solved_times);
}

/// Planners stand together in the order in which they first appear.
void group_planners(std::vector<Series>& all) {
  const std::vector<std::string> planners = different(all, &Series::planner);
  std::ranges::stable_sort(all, {}, [&](const Series& series) {
    return std::ranges::find(planners, series.planner) - planners.begin();
  });
}

/// Planners of mneme, and OMPL's counterparts.
constexpr std::array<std::pair<std::string_view, const char*>, 3> kCounterparts = {
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
  const auto found =
      std::ranges::find(kCounterparts, series.planner, [](const auto& pair) { return pair.first; });
  if (found == kCounterparts.end()) return nullptr;
  return find_series(panel, found->second, series.sampler, &series.setting);
}

}  // namespace

std::vector<Panel> make_panels(std::span<const BenchmarkRow> rows, bool by_problem) {
  std::vector<Panel> panels;
  for (const BenchmarkRow& row : rows) {
    Panel& panel = panel_of(row, by_problem, panels);
    panel.longest_limit = std::max(panel.longest_limit, row.timeout_s);
    BenchmarkRow& copy = series_of(row, panel.series).rows.emplace_back(row);
    copy.set = panel.name;
  }
  for (Panel& panel : panels) {
    for (Series& series : panel.series) finish(series);
    group_planners(panel.series);
  }
  return panels;
}

std::string short_label(const Series& series) {
  return single_line(series.sampler + (series.setting.empty() ? "" : ", " + series.setting));
}

std::string file_name(std::string_view text) {
  std::string name;
  for (const char c : text) {
    const bool is_plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '.';
    name += is_plain ? c : '_';
  }
  return name;
}

std::vector<SeriesRatio> compare_series(const Panel& panel, const std::string& baseline) {
  const auto name = [](const Series& series) {
    return series.planner + ", " + short_label(series);
  };
  std::vector<SeriesRatio> ratios;
  const auto add = [&](const Series& other, const Series* reference) {
    if (reference == nullptr || reference == &other) return;
    const PairedRatio ratio = compare_runs(reference->rows, other.rows);
    if (ratio.pairs > 0) ratios.push_back({panel.name, name(other), name(*reference), ratio});
  };
  for (const Series& s : panel.series) add(s, find_baseline(panel, s, baseline));
  for (const Series& s : panel.series) add(s, find_series(panel, s.planner, s.sampler, nullptr));
  for (const Series& s : panel.series) add(s, find_ompl(panel, s));
  return ratios;
}

}  // namespace mneme::internal

namespace mneme {

std::vector<SeriesRatio> compare_series(std::span<const BenchmarkRow> rows,
                                        const std::string& baseline) {
  const std::vector<internal::Panel> panels = internal::make_panels(rows, false);
  std::vector<SeriesRatio> ratios;
  const auto append = [&](const internal::Panel& panel) {
    std::ranges::move(internal::compare_series(panel, baseline), std::back_inserter(ratios));
  };
  std::ranges::for_each(panels, append);
  if (panels.size() <= 1) return ratios;
  std::vector<BenchmarkRow> pooled(rows.begin(), rows.end());
  for (BenchmarkRow& row : pooled) {
    row.problem = row.set + "#" + row.problem;
    row.set = "all";
  }
  append(internal::make_panels(pooled, false).front());
  return ratios;
}

}  // namespace mneme
