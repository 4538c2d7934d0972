// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/report.h"

#include "report/chart.h"
#include "report/markup.h"
#include "report/page.h"
#include "report/summary.h"

#include <fmt/format.h>

namespace mneme {
namespace {

constexpr std::string_view kChartRules = R"css(
.chart { display: block; width: 100%; min-width: 640px; max-width: 1080px;
  height: auto; font-size: 13px; }
.chart text { fill: var(--ink); }
.chart > text { fill: var(--soft); }
.chart .grid { stroke: var(--line); }
.chart .bar { fill: var(--color); }
.chart .bar.censored { fill-opacity: 0.25; stroke: var(--color); stroke-dasharray: 4 3; }
.chart .median, .chart .max { stroke: var(--color); stroke-width: 2; }
.chart .max.censored { stroke-dasharray: 2 2; }
.chart .whisker { stroke: var(--color); }
)css";

std::string chart_rules() {
  std::string text(kChartRules);
  for (int i = 0; i < internal::kChartColors; ++i) {
    text += fmt::format(".chart .sampler-{} {{ --color: var(--c{}); }}\n", i, i);
  }
  return text;
}

std::string table_row(const internal::RunGroup& group) {
  const TimeSummary& times = group.times;
  std::string row =
      fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td>", internal::escape_markup(group.problem),
                  internal::escape_markup(group.planner), internal::escape_markup(group.sampler));
  row += fmt::format("<td class=\"number{}\">{}/{}</td>", times.solved < times.runs ? " bad" : "",
                     times.solved, times.runs);
  row += fmt::format("<td class=\"number{}\">{}</td>", group.valid < times.solved ? " bad" : "",
                     group.valid);
  for (const int percent : {50, 95, 99, 100}) {
    row += fmt::format("<td class=\"number\">{}</td>",
                       internal::escape_markup(internal::format_percentile(times, percent)));
  }
  return row + "</tr>\n";
}

std::string times_section(std::span<const BenchmarkRow> rows) {
  const std::vector<internal::RunGroup> groups = internal::group_runs(rows);
  std::string html =
      "<h2>Planning times</h2>\n"
      "<p class=\"note\">Bars reach from the median to the 95th percentile, whiskers to the "
      "longest "
      "run; on the right, runs solved of all runs. A failure counts as longer than any success and "
      "stands at its time limit; what it bounds is dashed, or marked with &gt;.</p>\n";
  html += "<div class=\"card\">\n" + internal::time_chart(groups) + "</div>\n";
  html +=
      "<h2>Table</h2>\n<div class=\"card\"><table>\n<thead><tr><th>problem</th><th>planner</th>"
      "<th>sampler</th><th class=\"number\">solved</th><th class=\"number\">valid</th>"
      "<th class=\"number\">p50 ms</th><th class=\"number\">p95 ms</th>"
      "<th class=\"number\">p99 ms</th><th class=\"number\">max ms</th></tr></thead>\n<tbody>\n";
  for (const internal::RunGroup& group : groups) html += table_row(group);
  return html + "</tbody>\n</table></div>\n";
}

std::string pictures_section(std::span<const ReportPicture> pictures) {
  std::string html = "<h2>Pictures</h2>\n<div class=\"pictures\">\n";
  for (const ReportPicture& picture : pictures) {
    html += fmt::format("<figure class=\"card\">\n{}<figcaption>{}</figcaption>\n</figure>\n",
                        picture.svg, internal::escape_markup(picture.caption));
  }
  return html + "</div>\n";
}

}  // namespace

std::string to_html(const std::string& title, const std::string& introduction,
                    std::span<const BenchmarkRow> rows, std::span<const ReportPicture> pictures) {
  std::string html = internal::page_begin(title, chart_rules());
  if (!introduction.empty()) {
    html +=
        fmt::format("<p class=\"introduction\">{}</p>\n", internal::escape_markup(introduction));
  }
  if (!pictures.empty()) html += pictures_section(pictures);
  if (!rows.empty()) html += times_section(rows);
  return html + internal::page_end();
}

}  // namespace mneme
