// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "statistics/figures.h"
#include "statistics/summary.h"
#include "report/markup.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <initializer_list>

namespace mneme::internal {
namespace {

struct Column {
  const char* name;
  bool is_number = true;
};

std::string open_table(std::string_view kind, std::initializer_list<Column> columns) {
  std::string html = fmt::format("<div class=\"card\"><table class=\"{}\">\n<thead><tr>", kind);
  for (const Column& column : columns) {
    html += fmt::format("<th{}>{}</th>", column.is_number ? " class=\"number\"" : "",
                        escape_markup(column.name));
  }
  return html + "</tr></thead>\n<tbody>\n";
}

constexpr std::string_view kTableEnd = "</tbody>\n</table></div>\n";

std::string name_cell(std::string_view text) {
  return fmt::format("<td>{}</td>", escape_markup(text));
}

std::string number_cell(std::string_view text, bool is_bad = false) {
  return fmt::format("<td class=\"number{}\">{}</td>", is_bad ? " bad" : "", escape_markup(text));
}

std::string time_cell(const TimeSummary& times, int percent, double seconds) {
  return fmt::format("<td class=\"number\" data-seconds=\"{}\">{}</td>", seconds,
                     escape_markup(format_percentile(times, percent)));
}

std::string time_line(const Series& series) {
  const SetSummary& summary = series.summary;
  const TimeSummary& times = summary.times;
  std::string html =
      "<tr>" + name_cell(series.planner) + name_cell(series.sampler) + name_cell(series.setting);
  html += number_cell(fmt::format("{}/{}/{}", times.solved, summary.valid, summary.total),
                      times.solved < summary.valid);
  html += number_cell(std::to_string(summary.invalid_paths), summary.invalid_paths > 0);
  html += time_cell(times, 50, times.p50) + time_cell(times, 95, times.p95) +
          time_cell(times, 99, times.p99) + time_cell(times, 100, times.max);
  return html + number_cell(std::to_string(summary.iterations_p50)) + "</tr>\n";
}

std::string ratio_cell(const TimeRatio& ratio) {
  return fmt::format("<td class=\"number\" data-ratio=\"{}\">{}</td>", ratio.value,
                     format_ratio(ratio));
}

std::string ratio_line(const Comparison& comparison) {
  const PairedRatio& ratio = comparison.ratio;
  return "<tr>" + name_cell(series_name(*comparison.other)) +
         name_cell(series_name(*comparison.reference)) + number_cell(std::to_string(ratio.pairs)) +
         ratio_cell(ratio.p50) + ratio_cell(ratio.p95) + ratio_cell(ratio.p99) +
         ratio_cell(ratio.mean) + ratio_cell(ratio.geometric) + "</tr>\n";
}

}  // namespace

std::string time_table(const Panel& panel) {
  std::string html = open_table("times", {{"planner", false},
                                          {"sampler", false},
                                          {"setting", false},
                                          {"solved/valid/total"},
                                          {"bad paths"},
                                          {"p50 ms"},
                                          {"p95 ms"},
                                          {"p99 ms"},
                                          {"max ms"},
                                          {"iterations p50"}});
  for (const Series& series : panel.series) html += time_line(series);
  return html + std::string(kTableEnd);
}

std::string ratio_table(const std::vector<Comparison>& comparisons) {
  if (comparisons.empty()) return {};
  std::string html = open_table("ratios", {{"this", false},
                                           {"against", false},
                                           {"pairs"},
                                           {"p50"},
                                           {"p95"},
                                           {"p99"},
                                           {"mean"},
                                           {"geometric"}});
  for (const Comparison& comparison : comparisons) html += ratio_line(comparison);
  return html + std::string(kTableEnd);
}

std::string memory_table(std::span<const MemoryRow> memories) {
  std::string html = open_table(
      "memories",
      {{"memory", false}, {"primitives"}, {"components"}, {"file, kB"}, {"learned in, s"}});
  for (const MemoryRow& memory : memories) {
    html += "<tr>" + name_cell(memory.name) + number_cell(std::to_string(memory.primitives)) +
            number_cell(std::to_string(memory.components)) +
            number_cell(fmt::format("{:.0f}", static_cast<double>(memory.bytes) / 1e3)) +
            number_cell(fmt::format("{:.1f}", memory.learning_time_s)) + "</tr>\n";
  }
  return html + std::string(kTableEnd);
}

std::string settings_table(std::span<const BenchmarkRow> rows) {
  std::vector<std::array<std::string, 3>> lines;
  for (const BenchmarkRow& row : rows) {
    const std::array<std::string, 3> line = {row.setting, row.settings,
                                             fmt::format("{}", row.timeout_s)};
    if (std::ranges::find(lines, line) == lines.end()) lines.push_back(line);
  }
  std::string html = open_table(
      "settings", {{"setting", false}, {"what differs from the defaults", false}, {"limit s"}});
  for (const auto& [name, text, limit] : lines) {
    html += "<tr>" + name_cell(name) + "<td class=\"wide\">" +
            escape_markup(text.empty() ? "nothing" : text) + "</td>" + number_cell(limit) +
            "</tr>\n";
  }
  return html + std::string(kTableEnd);
}

}  // namespace mneme::internal
