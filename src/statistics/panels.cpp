// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "statistics/panels.h"

#include "mneme/statistics.h"

#include "statistics/summary.h"
#include "report/markup.h"

#include <fmt/format.h>

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
  const std::vector<std::string> planners = different(all, &Series::planner);
  std::ranges::stable_sort(all, {}, [&](const Series& series) {
    return std::ranges::find(planners, series.planner) - planners.begin();
  });
}

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

namespace mneme {
namespace {

void append_ratios(const internal::Panel& panel, const std::string& baseline,
                   std::vector<SeriesRatio>& ratios) {
  for (const auto& [kind, other, reference, ratio] : internal::compare_series(panel, baseline)) {
    ratios.push_back(
        {panel.name, internal::series_name(*other), internal::series_name(*reference), ratio});
  }
}

/// The rows as those of one set, whose problems keep the name of theirs.
std::vector<BenchmarkRow> pool(std::span<const BenchmarkRow> rows) {
  std::vector<BenchmarkRow> pooled(rows.begin(), rows.end());
  for (BenchmarkRow& row : pooled) {
    row.problem = row.set + "#" + row.problem;
    row.set = "all";
  }
  return pooled;
}

}  // namespace

std::vector<SeriesRatio> compare_series(std::span<const BenchmarkRow> rows,
                                        const std::string& baseline) {
  const std::vector<internal::Panel> panels = internal::make_panels(rows, false);
  std::vector<SeriesRatio> ratios;
  for (const internal::Panel& panel : panels) append_ratios(panel, baseline, ratios);
  if (panels.size() > 1) {
    append_ratios(internal::make_panels(pool(rows), false).front(), baseline, ratios);
  }
  return ratios;
}

std::string to_table(std::span<const SeriesRatio> ratios) {
  if (ratios.empty()) return {};
  constexpr std::size_t kNameColumns = 3;
  std::vector<std::vector<std::string>> lines = {
      {"set", "this", "against", "pairs", "p50", "p95", "p99", "mean", "geometric"}};
  for (const auto& [set, other, reference, ratio] : ratios) {
    lines.push_back({set, other, reference, std::to_string(ratio.pairs),
                     internal::format_ratio(ratio.p50), internal::format_ratio(ratio.p95),
                     internal::format_ratio(ratio.p99), internal::format_ratio(ratio.mean),
                     internal::format_ratio(ratio.geometric)});
  }
  return internal::text_table(lines, kNameColumns);
}

}  // namespace mneme
