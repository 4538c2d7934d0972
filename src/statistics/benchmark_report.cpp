// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/report.h"
#include "mneme/statistics.h"

#include "statistics/figures.h"
#include "statistics/panels.h"
#include "statistics/tables.h"
#include "report/markup.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

namespace mneme {
namespace {

using internal::escape_markup;
using internal::Panel;

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
.settings td { white-space: normal; overflow-wrap: anywhere; }
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
    "<p class=\"note\">Times are planning times: from call to return, with retrieval and learning, "
    "without scene tables, simplification and verification. A run without a path counts as longer "
    "than any success and is shown at its time limit; &gt; marks such lower bounds. Every path is "
    "checked again with exact distances in double precision, at ten times the resolution. Paths "
    "that fail this check count as not solved; the column bad paths counts them. Runs on problems "
    "with an invalid start or goal are in total, but not in valid.</p>\n";

constexpr std::string_view kHowLengthsFall =
    "<p class=\"note\">Lengths are means over the runs, as a share of each run's first path. Time "
    "starts when improving begins, after planning.</p>\n";

constexpr std::string_view kHowToReadDifficulty =
    "<p class=\"note\">Each dot is a problem and a planner, at its median time without memory "
    "(horizontal) and with it (vertical). Below the line memory is faster. Open dots: the median "
    "run found no path and is shown at its time limit.</p>\n";

constexpr std::string_view kHowToCompare =
    "<p class=\"note\">Ratios above 1 mean that the left one is faster, on the same problems and "
    "seeds. In the columns p50, p95 and p99 they are ratios of percentiles. The column mean is the "
    "ratio of arithmetic means, geometric the geometric mean of the pairs' ratios. Runs without a "
    "path count with their time limit: the ratio is then a lower bound (\u2265), an upper bound "
    "(\u2264), or open. In brackets: 95 % intervals by bootstrap percentiles.</p>\n";

/// "A; B"; files of older versions may lack the texts.
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
      "<footer>\n<p>Machine: {}. Kernels: {}. Built: {}.</p>\n<p>Runs: {}, timed {}, started {}. "
      "Report: "
      "{}.</p>\n</footer>\n",
      escape_markup(joined(internal::different(rows, &BenchmarkRow::machine))),
      escape_markup(joined(internal::different(rows, &BenchmarkRow::isa))),
      escape_markup(joined(internal::different(rows, &BenchmarkRow::version))), rows.size(),
      describe_timing(rows), escape_markup(when.empty() ? "at a time not recorded" : when),
      escape_markup(describe_build()));
}

std::string summary_line(std::span<const BenchmarkRow> rows) {
  const auto count = [&](auto&& is_one) { return std::ranges::count_if(rows, is_one); };
  return fmt::format(
      "<p>{} runs: {} solved, {} without a path, {} with a path that failed the check, {} "
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

/// Writes the page below the introduction.
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
    if (!memories.empty()) {
      html += "<h2>Memories</h2>\n" + to_html(internal::memory_table(memories), "memories");
    }
    html += "<h2>Settings</h2>\n" + to_html(internal::settings_table(rows_), "settings");
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
    add_figure(name + "_solved", internal::solved_curves(panel, samplers_));
    const std::string lengths = internal::length_curves(panel, samplers_);
    if (!lengths.empty()) {
      add_figure(name + "_lengths", lengths);
      report_.html += kHowLengthsFall;
    }
    const std::vector<SetSummary> summaries(panel.series.begin(), panel.series.end());
    report_.html +=
        to_html(internal::summary_table(
                    summaries, {"planner", "sampler", "setting", "solved/valid/total", "bad paths",
                                "p50 ms", "p95 ms", "p99 ms", "max ms", "iterations p50"}),
                "times");
    const auto ratios = internal::compare_series(panel, options_.baseline);
    if (ratios.empty()) return;
    report_.html += "<h3>Paired ratios</h3>\n";
    if (!std::exchange(is_comparison_explained_, true)) report_.html += kHowToCompare;
    report_.html += to_html(internal::ratio_table(ratios), "ratios");
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

Result<void> write_report(const std::string& path, const BenchmarkReport& report) {
  const std::filesystem::path stem = std::filesystem::path(path).replace_extension();
  if (stem.has_parent_path()) MNEME_TRY(make_directory(stem.parent_path().string()));
  for (const ReportFigure& figure : report.figures) {
    MNEME_TRY(write_file(fmt::format("{}_{}.svg", stem.string(), figure.name), figure.svg));
  }
  return write_file(path, report.html);
}

}  // namespace mneme
