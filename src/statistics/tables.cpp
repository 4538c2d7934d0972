// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "statistics/tables.h"

#include "statistics/panels.h"
#include "report/markup.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace mneme::internal {
namespace {

using Line = std::vector<TableCell>;

struct SummaryColumn {
  std::string_view name;
  bool is_name = false;
  TableCell (*cell)(const SetSummary& summary);
};

/// A percentile, marked with ">" if it is a failure.
TableCell time_cell(const TimeSummary& times, int percent, double seconds) {
  return {(is_censored(times, percent) ? ">" : "") + format_ms(seconds), false, seconds};
}

constexpr auto kSummaryColumns = std::to_array<SummaryColumn>({
    {"set", true, [](const SetSummary& s) { return TableCell{s.set}; }},
    {"problem", true, [](const SetSummary& s) { return TableCell{s.set}; }},
    {"planner", true, [](const SetSummary& s) { return TableCell{s.planner}; }},
    {"sampler", true, [](const SetSummary& s) { return TableCell{s.sampler}; }},
    {"setting", true, [](const SetSummary& s) { return TableCell{s.setting}; }},
    {"solved/valid/total", false,
     [](const SetSummary& s) {
       return TableCell{fmt::format("{}/{}/{}", s.times.solved, s.valid, s.total),
                        s.times.solved < s.valid};
     }},
    {"bad paths", false,
     [](const SetSummary& s) {
       return TableCell{std::to_string(s.invalid_paths), s.invalid_paths > 0};
     }},
    {"p50 ms", false, [](const SetSummary& s) { return time_cell(s.times, 50, s.times.p50); }},
    {"mean ms", false,
     [](const SetSummary& s) {
       const bool is_bound = s.times.solved < s.times.runs;
       return TableCell{(is_bound ? ">" : "") + format_ms(s.times.mean)};
     }},
    {"p95 ms", false, [](const SetSummary& s) { return time_cell(s.times, 95, s.times.p95); }},
    {"p99 ms", false, [](const SetSummary& s) { return time_cell(s.times, 99, s.times.p99); }},
    {"max ms", false, [](const SetSummary& s) { return time_cell(s.times, 100, s.times.max); }},
    {"total p50 ms", false,
     [](const SetSummary& s) { return time_cell(s.total_times, 50, s.total_times.p50); }},
    {"total p99 ms", false,
     [](const SetSummary& s) { return time_cell(s.total_times, 99, s.total_times.p99); }},
    {"total max ms", false,
     [](const SetSummary& s) { return time_cell(s.total_times, 100, s.total_times.max); }},
    {"iterations p50", false,
     [](const SetSummary& s) { return TableCell{std::to_string(s.iterations_p50)}; }},
    {"states p50", false,
     [](const SetSummary& s) { return TableCell{std::to_string(s.states_p50)}; }},
    {"mean length", false,
     [](const SetSummary& s) { return TableCell{fmt::format("{:.2f}", s.path_length_mean)}; }},
    {"mean duration s", false,
     [](const SetSummary& s) { return TableCell{fmt::format("{:.2f}", s.duration_mean_s)}; }},
});

std::string cell_html(const TableCell& cell, bool is_name) {
  std::string attributes = is_name ? "" : " class=\"number\"";
  if (cell.is_bad) attributes = " class=\"number bad\"";
  if (cell.exact) attributes += fmt::format(" data-value=\"{}\"", *cell.exact);
  return fmt::format("<td{}>{}</td>", attributes, escape_markup(cell.text));
}

std::string format_number(double ratio) {
  if (ratio >= 100) return fmt::format("{:.0f}", ratio);
  if (ratio >= 10) return fmt::format("{:.1f}", ratio);
  return ratio >= 0.1 ? fmt::format("{:.2f}", ratio) : fmt::format("{:.2g}", ratio);
}

}  // namespace

std::string to_text(const Table& table) {
  std::vector<std::vector<std::string>> lines = {table.header};
  for (const Line& line : table.lines) {
    auto& texts = lines.emplace_back();
    for (const TableCell& cell : line) texts.push_back(single_line(cell.text));
  }
  std::vector<int> widths(table.header.size());
  for (const auto& line : lines) {
    for (std::size_t i = 0; i < line.size(); ++i) {
      widths[i] = std::max(widths[i], character_count(line[i]));
    }
  }
  std::string text;
  for (const auto& line : lines) {
    for (std::size_t i = 0; i < line.size(); ++i) {
      const std::string padding(static_cast<std::size_t>(widths[i] - character_count(line[i])),
                                ' ');
      text += i < table.name_columns ? line[i] + padding : padding + line[i];
      text += i + 1 < line.size() ? "  " : "\n";
    }
  }
  return text;
}

std::string to_html(const Table& table, std::string_view kind) {
  if (table.lines.empty()) return {};
  std::string html = fmt::format("<div class=\"card\"><table class=\"{}\">\n<thead><tr>", kind);
  for (std::size_t i = 0; i < table.header.size(); ++i) {
    html += fmt::format("<th{}>{}</th>", i < table.name_columns ? "" : " class=\"number\"",
                        escape_markup(table.header[i]));
  }
  html += "</tr></thead>\n<tbody>\n";
  for (const Line& line : table.lines) {
    html += "<tr>";
    for (std::size_t i = 0; i < line.size(); ++i) {
      html += cell_html(line[i], i < table.name_columns);
    }
    html += "</tr>\n";
  }
  return html + "</tbody>\n</table></div>\n";
}

Table summary_table(std::span<const SetSummary> summaries,
                    std::initializer_list<std::string_view> columns) {
  Table table;
  table.lines.resize(summaries.size());
  for (const std::string_view name : columns) {
    const SummaryColumn& column = *std::ranges::find(kSummaryColumns, name, &SummaryColumn::name);
    table.name_columns += column.is_name ? 1 : 0;
    table.header.emplace_back(name);
    for (std::size_t i = 0; i < summaries.size(); ++i) {
      table.lines[i].push_back(column.cell(summaries[i]));
    }
  }
  return table;
}

Table ratio_table(std::span<const SeriesRatio> ratios) {
  Table table{2, {"this", "against", "pairs", "p50", "p95", "p99", "mean", "geometric"}, {}};
  for (const auto& [set, other, reference, ratio] : ratios) {
    Line& line =
        table.lines.emplace_back(Line{{other}, {reference}, {std::to_string(ratio.pairs)}});
    for (const TimeRatio& one : {ratio.p50, ratio.p95, ratio.p99, ratio.mean, ratio.geometric}) {
      line.push_back({format_ratio(one), false, one.value});
    }
  }
  return table;
}

Table memory_table(std::span<const MemoryRow> memories) {
  Table table{1, {"memory", "primitives", "components", "file, kB", "learned in, s"}, {}};
  for (const MemoryRow& memory : memories) {
    table.lines.push_back({{memory.name},
                           {std::to_string(memory.primitives)},
                           {std::to_string(memory.components)},
                           {fmt::format("{:.0f}", static_cast<double>(memory.bytes) / 1e3)},
                           {fmt::format("{:.1f}", memory.learning_time_s)}});
  }
  return table;
}

Table settings_table(std::span<const BenchmarkRow> rows) {
  std::vector<std::array<std::string, 3>> settings;
  for (const BenchmarkRow& row : rows) {
    const std::string values = row.settings.empty() ? "none" : row.settings;
    const std::array line = {row.setting, values, fmt::format("{}", row.timeout_s)};
    if (std::ranges::find(settings, line) == settings.end()) settings.push_back(line);
  }
  Table table{2, {"setting", "values that are not the defaults", "limit s"}, {}};
  for (const auto& [name, values, limit] : settings) {
    table.lines.push_back({{name}, {values}, {limit}});
  }
  return table;
}

int nearest_rank(int percent, int count) { return std::max(1, (percent * count + 99) / 100); }

bool is_censored(const TimeSummary& times, int percent) {
  return nearest_rank(percent, times.runs) > times.solved;
}

std::string format_ms(double seconds) {
  const double ms = seconds * 1e3;
  if (ms >= 100) return fmt::format("{:.0f}", ms);
  if (ms >= 10) return fmt::format("{:.1f}", ms);
  return fmt::format("{:.2f}", ms);
}

std::string format_ratio(const TimeRatio& ratio) {
  if (ratio.is_at_least && ratio.is_at_most) return "open";
  const char* mark = ratio.is_at_least ? "≥ " : ratio.is_at_most ? "≤ " : "";
  return fmt::format("{}{} ({} to {})", mark, format_number(ratio.value), format_number(ratio.low),
                     format_number(ratio.high));
}

}  // namespace mneme::internal

namespace mneme {

std::string to_table(std::span<const SetSummary> summaries) {
  internal::Table table = internal::summary_table(
      summaries,
      {"set", "planner", "sampler", "setting", "solved/valid/total", "bad paths", "p50 ms",
       "mean ms", "p95 ms", "p99 ms", "max ms", "total p50 ms", "total p99 ms", "total max ms",
       "iterations p50", "states p50", "mean length", "mean duration s"});
  constexpr std::ptrdiff_t kSettingColumn = 3;
  if (std::ranges::all_of(summaries, [](const SetSummary& s) { return s.setting.empty(); })) {
    --table.name_columns;
    table.header.erase(table.header.begin() + kSettingColumn);
    for (auto& line : table.lines) line.erase(line.begin() + kSettingColumn);
  }
  return to_text(table);
}

std::string to_table(std::span<const BenchmarkRow> rows) {
  std::vector<BenchmarkRow> by_problem(rows.begin(), rows.end());
  for (BenchmarkRow& row : by_problem) {
    row.set = row.problem;
    row.setting.clear();
  }
  return to_text(internal::summary_table(internal::summarize_each(by_problem),
                                         {"problem", "planner", "sampler", "solved/valid/total",
                                          "bad paths", "p50 ms", "p95 ms", "p99 ms", "max ms"}));
}

std::string to_table(std::span<const SeriesRatio> ratios) {
  if (ratios.empty()) return {};
  internal::Table table = internal::ratio_table(ratios);
  ++table.name_columns;
  table.header.insert(table.header.begin(), "set");
  for (std::size_t i = 0; i < ratios.size(); ++i) {
    table.lines[i].insert(table.lines[i].begin(), {ratios[i].set});
  }
  return to_text(table);
}

}  // namespace mneme
