// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmark/panels.h"

#include "report/markup.h"

#include <algorithm>
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
  Series series;
  series.planner = row.planner;
  series.sampler = row.sampler;
  series.setting = row.setting;
  all.push_back(std::move(series));
  return all.back();
}

void finish(Series& series) {
  series.summary = summarize_sets(series.rows).front();
  std::erase_if(series.rows, is_invalid_problem);
  for (const BenchmarkRow& row : series.rows) {
    if (is_success(row)) {
      series.solved_times.push_back(row.planning_time_s);
    } else {
      series.limits.push_back(row.timeout_s);
    }
  }
  std::ranges::sort(series.solved_times);
  std::ranges::sort(series.limits);
}

/// Planners stand together in the order in which they first appear.
void group_planners(std::vector<Series>& all) {
  std::vector<std::string> planners;
  for (const Series& series : all) {
    if (std::ranges::find(planners, series.planner) == planners.end()) {
      planners.push_back(series.planner);
    }
  }
  std::ranges::stable_sort(all, {}, [&](const Series& series) {
    return std::ranges::find(planners, series.planner) - planners.begin();
  });
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
  const std::string setting = single_line(series.setting);
  return single_line(series.sampler) + (setting.empty() ? "" : ", " + setting);
}

std::string file_name(std::string_view text) {
  std::string name;
  for (const char c : text) {
    const bool is_plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '.';
    name += is_plain ? c : '_';
  }
  return name;
}

}  // namespace mneme::internal
