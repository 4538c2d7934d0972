// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmark/figures.h"
#include "report/markup.h"

#include <fmt/format.h>

#include <algorithm>

namespace mneme::internal {
namespace {

constexpr double kCurveWidth = 960;
constexpr int kColumns = 2;
constexpr double kCurveLeft = 52;
constexpr double kCurveTop = 34;
constexpr double kDiagramWidth = 400;
constexpr double kDiagramHeight = 190;
constexpr double kColumnPitch = 480;
constexpr double kRowPitch = 262;
constexpr double kLegendLine = 20;
constexpr double kLegendPitch = 310;
constexpr int kLegendColumns = 3;
constexpr double kCurveShortest = 1e-6;  // seconds

class Curves {
 public:
  Curves(const Panel& panel, const std::vector<std::string>& samplers)
      : panel_(panel),
        samplers_(samplers),
        planners_(different(panel.series, &Series::planner)),
        settings_(different(panel.series, &Series::setting)) {}

  std::string draw() {
    const std::vector<const Series*> legend = legend_entries();
    const auto rows = static_cast<double>((planners_.size() + kColumns - 1) / kColumns);
    const auto lines = static_cast<double>((legend.size() + kLegendColumns - 1) / kLegendColumns);
    const double legend_top = kCurveTop + rows * kRowPitch - 26;
    const double height = legend_top + lines * kLegendLine + 8;
    svg_.open("svg", {{"class", "plot curves"},
                      {"xmlns", "http://www.w3.org/2000/svg"},
                      {"viewBox", fmt::format("0 0 {} {}", kCurveWidth, short_number(height))},
                      {"width", short_number(kCurveWidth)},
                      {"role", "img"},
                      {"aria-label", "Runs solved over time, " + single_line(panel_.name)}});
    svg_.element("rect", {{"class", "paper"}, {"width", "100%"}, {"height", "100%"}});
    make_axis();
    for (std::size_t i = 0; i < planners_.size(); ++i) draw_diagram(i);
    for (std::size_t i = 0; i < legend.size(); ++i) draw_legend(*legend[i], i, legend_top);
    svg_.close();
    return svg_.str();
  }

 private:
  void make_axis() {
    double least = panel_.longest_limit > 0 ? panel_.longest_limit : 1;
    double most = kCurveShortest;
    for (const Series& series : panel_.series) {
      if (series.solved_times.empty()) continue;
      least = std::min(least, series.solved_times.front());
      most = std::max(most, series.solved_times.back());
    }
    least = std::max(least, kCurveShortest);
    most = std::max({most, panel_.longest_limit, 3 * least});
    axis_ = {least / 1.5, most * 1.1, 0, kDiagramWidth};
  }

  void draw_diagram(std::size_t i) {
    const Point origin{kCurveLeft + kColumnPitch * static_cast<double>(i % kColumns),
                       kCurveTop + kRowPitch * static_cast<double>(i / kColumns)};
    const double bottom = origin.y + kDiagramHeight;
    draw_text(svg_, "head", {origin.x, origin.y - 14}, "start",
              shortened(single_line(planners_[i]), 30));
    draw_text(svg_, "soft", {origin.x + kDiagramWidth, origin.y - 14}, "end",
              "solved within the time");
    for (const int percent : {0, 25, 50, 75, 100}) {
      const double y = bottom - kDiagramHeight * percent / 100;
      draw_line(svg_, "grid", {origin.x, y}, {origin.x + kDiagramWidth, y});
      draw_text(svg_, "soft", {origin.x - 7, y + 4}, "end", fmt::format("{} %", percent));
    }
    for (const Tick& tick : ticks_of(axis_)) {
      const double x = origin.x + axis_.at(tick.seconds);
      draw_line(svg_, tick.label.empty() ? "faint" : "grid", {x, origin.y}, {x, bottom});
      if (!tick.label.empty()) draw_text(svg_, "soft", {x, bottom + 17}, "middle", tick.label);
    }
    for (const Series& series : panel_.series) {
      if (series.planner == planners_[i]) draw_curve(series, {origin.x, bottom});
    }
    draw_line(svg_, "frame", {origin.x, bottom}, {origin.x + kDiagramWidth, bottom});
  }

  void draw_curve(const Series& series, Point origin) {
    if (series.run_count() == 0) return;
    const double step = kDiagramHeight / series.run_count();
    std::vector<Point> points = {{origin.x, origin.y}};
    for (const double time : series.solved_times) {
      const double x = origin.x + axis_.at(time);
      points.push_back({x, points.back().y});
      points.push_back({x, points.back().y - step});
    }
    double end = 0;
    for (const BenchmarkRow& row : series.rows) end = std::max(end, row.timeout_s);
    points.push_back({std::max(origin.x + axis_.at(end), points.back().x), points.back().y});
    svg_.open("g", {{"class", color_class(series.sampler, samplers_)}});
    svg_.text_element("title", {},
                      fmt::format("{}, {}: {}/{} solved", series.planner, short_label(series),
                                  series.summary.times.solved, series.run_count()));
    svg_.element(
        "polyline",
        {{"class", "curve"}, {"stroke-dasharray", dash(series)}, {"points", short_points(points)}});
    svg_.close();
  }

  [[nodiscard]] std::string dash(const Series& series) const {
    const auto position = std::ranges::find(settings_, series.setting) - settings_.begin();
    const std::string pattern = dash_of(static_cast<std::size_t>(position));
    return pattern.empty() ? "none" : pattern;
  }

  /// One series for each sampler and setting.
  [[nodiscard]] std::vector<const Series*> legend_entries() const {
    std::vector<const Series*> entries;
    for (const Series& series : panel_.series) {
      const bool is_new = std::ranges::none_of(entries, [&](const Series* entry) {
        return entry->sampler == series.sampler && entry->setting == series.setting;
      });
      if (is_new) entries.push_back(&series);
    }
    return entries;
  }

  void draw_legend(const Series& series, std::size_t i, double top) {
    const double x = kCurveLeft + kLegendPitch * static_cast<double>(i % kLegendColumns);
    const double y = top + kLegendLine * static_cast<double>(i / kLegendColumns) + 10;
    svg_.open("g", {{"class", "legend " + color_class(series.sampler, samplers_)}});
    svg_.element("line", {{"class", "curve"},
                          {"stroke-dasharray", dash(series)},
                          {"x1", short_number(x)},
                          {"x2", short_number(x + 34)},
                          {"y1", short_number(y - 4)},
                          {"y2", short_number(y - 4)}});
    draw_text(svg_, "label", {x + 42, y}, "start", shortened(short_label(series), 40));
    svg_.close();
  }

  const Panel& panel_;
  const std::vector<std::string>& samplers_;
  std::vector<std::string> planners_;
  std::vector<std::string> settings_;
  SvgWriter svg_;
  TimeAxis axis_;
};

}  // namespace

std::string solved_curves(const Panel& panel, const std::vector<std::string>& samplers) {
  return Curves(panel, samplers).draw();
}

}  // namespace mneme::internal
