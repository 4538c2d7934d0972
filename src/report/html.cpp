// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/report.h"

#include "report/chart.h"
#include "report/markup.h"
#include "report/summary.h"

#include <fmt/format.h>

namespace mneme {
namespace {

constexpr std::string_view kStyle = R"css(
:root { color-scheme: light dark; --page: #f4f6fa; --card: #ffffff; --ink: #1f2937; --soft: #5b6675;
  --line: #dde3ec; --bad: #b42318; --c0: #c76a00; --c1: #5a7bb0; --c2: #0b8a6a; --c3: #8250df;
  --c4: #bf2c86; --c5: #5f8416; }
@media (prefers-color-scheme: dark) { :root { --page: #12161d; --card: #1b212b; --ink: #e6eaf0;
  --soft: #9aa6b6; --line: #323b49; --bad: #ff8a80; --c0: #f0a04b; --c1: #8fb0e6; --c2: #4cc3a1;
  --c3: #b79bff; --c4: #f07fc0; --c5: #a9cf5a; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--ink);
  font: 16px/1.5 Inter, "Helvetica Neue", Helvetica, Arial, "DejaVu Sans", sans-serif; }
main { max-width: 1320px; margin: 0 auto; padding: 32px 20px 56px; }
h1 { font-size: 30px; line-height: 1.2; margin: 0 0 12px; }
h2 { font-size: 20px; margin: 40px 0 12px; }
p { max-width: 72ch; margin: 0 0 12px; }
.introduction { white-space: pre-line; }
.note, figcaption { color: var(--soft); font-size: 14px; }
.card { background: var(--card); border: 1px solid var(--line); border-radius: 10px; padding: 18px;
  overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-size: 14px;
  font-variant-numeric: tabular-nums; }
th, td { padding: 6px 12px; text-align: left; border-bottom: 1px solid var(--line);
  white-space: nowrap; }
th { color: var(--soft); font-weight: 600; }
tbody tr:last-child td { border-bottom: 0; }
.number { text-align: right; }
.bad { color: var(--bad); font-weight: 600; }
.pictures { display: grid; gap: 20px;
  grid-template-columns: repeat(auto-fill, minmax(min(100%, 520px), 1fr)); }
figure { margin: 0; }
figure > svg { display: block; width: 100%; height: auto; }
figcaption { padding-top: 10px; }
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

std::string style() {
  std::string text(kStyle);
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
  const std::string heading = internal::escape_markup(title);
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{}</title>\n<style>{}</style>\n</head>\n<body>\n<main>\n<h1>{}</h1>\n",
      heading, style(), heading);
  if (!introduction.empty()) {
    html +=
        fmt::format("<p class=\"introduction\">{}</p>\n", internal::escape_markup(introduction));
  }
  if (!pictures.empty()) html += pictures_section(pictures);
  if (!rows.empty()) html += times_section(rows);
  return html + "</main>\n</body>\n</html>\n";
}

}  // namespace mneme
