// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/statistics.h"

#include "statistics/figures.h"
#include "statistics/panels.h"
#include "report/markup.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace mneme {
namespace {

using internal::escape_markup;
using internal::Panel;

/// Light and dark, nothing from elsewhere.
constexpr std::string_view kPageStyle = R"css(
:root { color-scheme: light dark; --page: #f4f6fa; --card: #ffffff; --ink: #1f2937; --soft: #5b6675;
  --line: #dde3ec; --bad: #b42318; }
@media (prefers-color-scheme: dark) { :root { --page: #12161d; --card: #1b212b; --ink: #e6eaf0;
  --soft: #9aa6b6; --line: #323b49; --bad: #ff8a80; } }
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
figure svg { display: block; width: 100%; height: auto; }
figcaption { padding-top: 10px; }
.wide { white-space: normal; overflow-wrap: anywhere; }
.figure { margin: 0 0 20px; }
.figure svg { display: block; max-width: 100%; height: auto; margin: 0 auto; }
.card + .card { margin-top: 20px; }
.pictures .card { margin-top: 0; }
nav a { margin-right: 16px; }
a { color: inherit; }
footer { margin-top: 48px; padding-top: 16px; border-top: 1px solid var(--line);
  color: var(--soft); font-size: 14px; }
)css";

constexpr std::string_view kHowToRead =
    "<p class=\"note\">Times are planning times: from call to return without simplification and "
    "verification, retrieval and learning included, tables of the scene left out. A run without a "
    "path counts as longer than any success and stands at its time limit; &gt; marks what it "
    "bounds. Every path is checked again at ten times the resolution by exact distances in double "
    "precision; one that does not survive counts as not solved, and the column bad paths says how "
    "many there were. Runs on problems with an invalid start or goal are in total, not in valid. "
    "Boxes reach from the first to the third quartile, whiskers to the shortest and the longest "
    "run, dots are runs, crosses time-outs at the limit.</p>\n";

constexpr std::string_view kHowLengthsFall =
    "<p class=\"note\">Lengths are the mean of what is left of each run's first path while it is "
    "improved, over the time since improving began, which is no planning time.</p>\n";

constexpr std::string_view kHowToReadDifficulty =
    "<p class=\"note\">A dot is a problem and a planner: how hard the problem is without, across, "
    "and "
    "what it takes with, up. Below the line it is faster; open dots have medians that are runs "
    "without "
    "a path, at their limit.</p>\n";

constexpr std::string_view kHowToCompare =
    "<p class=\"note\">Ratios above 1 say that the left one is faster, on the same problems and "
    "seeds. p50, p95 and p99 are the ratios of these percentiles, mean that of the arithmetic "
    "means, geometric the geometric mean of the ratios of pairs; runs without a path stand at "
    "their limit. \u2265 if what the right one gives is such a run, or holds one; \u2264 if what "
    "the left one gives; open if both. In brackets: 95 % intervals, bootstrap percentiles.</p>\n";

/// "A; B", or a word for what files of older versions do not say.
std::string joined(std::vector<std::string> texts) {
  std::erase(texts, "");
  std::string text;
  for (const std::string& part : texts) text += (text.empty() ? "" : "; ") + part;
  return text.empty() ? "not recorded" : text;
}

std::string footer(std::span<const BenchmarkRow> rows) {
  const auto [first, last] = std::ranges::minmax(rows, {}, &BenchmarkRow::started);
  std::string when = first.started;
  if (last.started != first.started) when += " to " + last.started;
  return fmt::format(
      "<footer>\n<p>Machine: {}. Kernels: {}. Built: {}.</p>\n<p>Runs: {}, started {}. Report: "
      "{}.</p>\n</footer>\n",
      escape_markup(joined(internal::different(rows, &BenchmarkRow::machine))),
      escape_markup(joined(internal::different(rows, &BenchmarkRow::isa))),
      escape_markup(joined(internal::different(rows, &BenchmarkRow::version))), rows.size(),
      escape_markup(when.empty() ? "at a time not recorded" : when),
      escape_markup(describe_build()));
}

std::string summary_line(std::span<const BenchmarkRow> rows) {
  const auto count = [&](auto&& is_one) { return std::ranges::count_if(rows, is_one); };
  return fmt::format(
      "<p>{} runs: {} solved, {} without a path, {} with a path that did not survive the check, {} "
      "on problems with an invalid start or goal.</p>\n",
      rows.size(), count(is_success),
      count([](const BenchmarkRow& r) { return !r.is_solved && !is_invalid_problem(r); }),
      count([](const BenchmarkRow& r) { return r.is_solved && !r.is_path_valid; }),
      count(is_invalid_problem));
}

std::string page_begin(const std::string& title) {
  const std::string heading = escape_markup(title);
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{}</title>\n<style>{}{}</style>\n</head>\n<body>\n<main>\n<h1>{}</h1>\n",
      heading, kPageStyle, internal::figure_style(), heading);
}

std::string introduction(const ReportOptions& options) {
  std::string html;
  if (!options.introduction.empty()) {
    html += fmt::format("<p class=\"introduction\">{}</p>\n", escape_markup(options.introduction));
  }
  if (options.pictures.empty()) return html;
  html += "<h2>Pictures</h2>\n<div class=\"pictures\">\n";
  for (const ReportPicture& picture : options.pictures) {
    const std::string svg = picture.page.empty()
                                ? picture.svg
                                : fmt::format("<a href=\"{}\" title=\"Open the plan\">\n{}</a>\n",
                                              escape_markup(picture.page), picture.svg);
    html += fmt::format("<figure class=\"card\">\n{}<figcaption>{}</figcaption>\n</figure>\n", svg,
                        escape_markup(picture.caption));
  }
  return html + "</div>\n<h2>Runs</h2>\n";
}

/// What stands below the introduction.
class ReportWriter {
 public:
  ReportWriter(std::span<const BenchmarkRow> rows, const ReportOptions& options)
      : rows_(rows),
        options_(options),
        panels_(internal::make_panels(rows, options.by_problem)),
        samplers_(internal::different(rows, &BenchmarkRow::sampler)) {}

  BenchmarkReport write(std::span<const MemoryRow> memories) {
    std::string& html = report_.html;
    html = summary_line(rows_) + std::string(kHowToRead);
    if (options_.by_problem) write_difficulty();
    if (panels_.size() > 1) html += contents();
    for (std::size_t i = 0; i < panels_.size(); ++i) write_panel(panels_[i], i);
    if (!memories.empty()) html += "<h2>Memories</h2>\n" + internal::memory_table(memories);
    html += "<h2>Settings</h2>\n" + internal::settings_table(rows_);
    html += footer(rows_);
    return std::move(report_);
  }

 private:
  [[nodiscard]] std::string contents() const {
    std::string html = "<nav>";
    for (std::size_t i = 0; i < panels_.size(); ++i) {
      html += fmt::format("<a href=\"#panel-{}\">{}</a>", i, escape_markup(panels_[i].name));
    }
    return html + "</nav>\n";
  }

  /// One figure for each sampler that is compared.
  void write_difficulty() {
    for (const std::string& sampler : samplers_) {
      if (sampler == options_.baseline) continue;
      const std::string svg = internal::difficulty_figure(panels_, options_.baseline, sampler);
      if (svg.empty()) continue;
      report_.html += fmt::format("<h2>{} against difficulty</h2>\n", escape_markup(sampler));
      add_figure("difficulty_" + internal::file_name(sampler), svg);
      report_.html += kHowToReadDifficulty;
    }
  }

  void write_panel(const Panel& panel, std::size_t index) {
    report_.html += fmt::format("<h2 id=\"panel-{}\">{}</h2>\n", index, escape_markup(panel.name));
    const std::string name = fmt::format("{}_{}", index + 1, internal::file_name(panel.name));
    add_figure(name + "_times", internal::box_plot(panel, samplers_));
    add_figure(name + "_solved", internal::solved_curves(panel, samplers_));
    const std::string lengths = internal::length_curves(panel, samplers_);
    if (!lengths.empty()) {
      add_figure(name + "_lengths", lengths);
      report_.html += kHowLengthsFall;
    }
    report_.html += internal::time_table(panel);
    const auto comparisons = internal::compare_series(panel, options_.baseline);
    if (comparisons.empty()) return;
    report_.html += "<h3>Paired ratios</h3>\n";
    if (!std::exchange(is_comparison_explained_, true)) report_.html += kHowToCompare;
    report_.html += internal::ratio_table(comparisons);
  }

  void add_figure(const std::string& name, const std::string& svg) {
    report_.html += "<div class=\"card figure\">\n" + svg + "</div>\n";
    report_.figures.push_back({name, internal::to_document(svg)});
  }

  std::span<const BenchmarkRow> rows_;
  const ReportOptions& options_;
  std::vector<Panel> panels_;
  std::vector<std::string> samplers_;
  bool is_comparison_explained_ = false;
  BenchmarkReport report_;
};

}  // namespace

BenchmarkReport make_benchmark_report(std::span<const BenchmarkRow> rows,
                                      std::span<const MemoryRow> memories,
                                      const ReportOptions& options) {
  BenchmarkReport report;
  if (!rows.empty()) report = ReportWriter(rows, options).write(memories);
  report.html = page_begin(options.title) + introduction(options) + report.html +
                "</main>\n</body>\n</html>\n";
  return report;
}

}  // namespace mneme
