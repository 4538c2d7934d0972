// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "statistics/figures.h"
#include "report/markup.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

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
constexpr int kShareTicks = 4;

/// The curve has the value `share` from `seconds` until the next step.
struct Step {
  double seconds = 0;
  double share = 0;
};

/// The curve of a series; its value before the first step is `first_share`.
struct Curve {
  const Series* series = nullptr;
  double first_share = 0;
  std::vector<Step> steps;
  double end_s = 0;
  std::string title;
};

class Curves {
 public:
  Curves(const Panel& panel, const std::vector<std::string>& samplers)
      : panel_(panel), samplers_(samplers), settings_(different(panel.series, &Series::setting)) {}

  /// The vertical axis runs from `lowest` to 1, the time axis to `longest_s` or further.
  std::string draw(const std::string& title, const std::string& axis_name,
                   const std::vector<Curve>& curves, double lowest, double longest_s) {
    lowest_ = lowest;
    axis_name_ = axis_name;
    make_axis(curves, longest_s);
    const std::vector<std::string> planners = different(panel_.series, &Series::planner);
    const std::vector<const Series*> legend = legend_entries();
    const auto rows = static_cast<double>((planners.size() + kColumns - 1) / kColumns);
    const auto lines = static_cast<double>((legend.size() + kLegendColumns - 1) / kLegendColumns);
    const double legend_top = kCurveTop + rows * kRowPitch - 26;
    open_figure(svg_, "plot curves", kCurveWidth, legend_top + lines * kLegendLine + 8,
                title + ", " + single_line(panel_.name));
    for (std::size_t i = 0; i < planners.size(); ++i) draw_diagram(planners[i], i, curves);
    for (std::size_t i = 0; i < legend.size(); ++i) draw_legend(*legend[i], i, legend_top);
    svg_.close();
    return svg_.str();
  }

 private:
  void make_axis(const std::vector<Curve>& curves, double longest_s) {
    double least = longest_s > 0 ? longest_s : 1;
    double most = kCurveShortest;
    for (const Curve& curve : curves) {
      if (curve.steps.empty()) continue;
      least = std::min(least, curve.steps.front().seconds);
      most = std::max(most, curve.steps.back().seconds);
    }
    least = std::max(least, kCurveShortest);
    most = std::max({most, longest_s, 3 * least});
    axis_ = {least / 1.5, most * 1.1, kDiagramWidth};
  }

  [[nodiscard]] double height_of(double share) const {
    return kDiagramHeight * (share - lowest_) / (1 - lowest_);
  }

  void draw_diagram(const std::string& planner, std::size_t i, const std::vector<Curve>& curves) {
    const Point origin{kCurveLeft + kColumnPitch * static_cast<double>(i % kColumns),
                       kCurveTop + kRowPitch * static_cast<double>(i / kColumns)};
    const double bottom = origin.y + kDiagramHeight;
    draw_text(svg_, "head", {origin.x, origin.y - 14}, "start",
              shortened(single_line(planner), 30));
    draw_text(svg_, "soft", {origin.x + kDiagramWidth, origin.y - 14}, "end", axis_name_);
    for (int tick = 0; tick <= kShareTicks; ++tick) {
      const double share = lowest_ + (1 - lowest_) * tick / kShareTicks;
      const double y = bottom - height_of(share);
      draw_line(svg_, "grid", {origin.x, y}, {origin.x + kDiagramWidth, y});
      draw_text(svg_, "soft", {origin.x - 7, y + 4}, "end", short_number(100 * share) + " %");
    }
    for (const Tick& tick : ticks_of(axis_)) {
      const double x = origin.x + axis_.at(tick.seconds);
      draw_line(svg_, tick.label.empty() ? "faint" : "grid", {x, origin.y}, {x, bottom});
      if (!tick.label.empty()) draw_text(svg_, "soft", {x, bottom + 17}, "middle", tick.label);
    }
    for (const Curve& curve : curves) {
      if (curve.series->planner == planner) draw_curve(curve, {origin.x, bottom});
    }
    draw_line(svg_, "frame", {origin.x, bottom}, {origin.x + kDiagramWidth, bottom});
  }

  void draw_curve(const Curve& curve, Point origin) {
    std::vector<Point> points = {{origin.x, origin.y - height_of(curve.first_share)}};
    for (const Step& step : curve.steps) {
      const double x = origin.x + axis_.at(step.seconds);
      points.push_back({x, points.back().y});
      points.push_back({x, origin.y - height_of(step.share)});
    }
    points.push_back(
        {std::max(origin.x + axis_.at(curve.end_s), points.back().x), points.back().y});
    svg_.open("g", {{"class", color_class(curve.series->sampler, samplers_)}});
    svg_.text_element("title", {}, curve.title);
    svg_.element("polyline", {{"class", "curve"},
                              {"stroke-dasharray", dash(*curve.series)},
                              {"points", short_points(points)}});
    svg_.close();
  }

  [[nodiscard]] std::string dash(const Series& series) const {
    const auto position = std::ranges::find(settings_, series.setting) - settings_.begin();
    return dash_of(static_cast<std::size_t>(position));
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
  std::string axis_name_;
  std::vector<std::string> settings_;
  double lowest_ = 0;
  SvgWriter svg_;
  TimeAxis axis_;
};

Curve solved_curve(const Series& series) {
  Curve curve{&series, 0, {}, 0, ""};
  for (const double time_s : series.solved_times) {
    const auto solved = static_cast<double>(curve.steps.size() + 1);
    curve.steps.push_back({time_s, solved / series.valid});
  }
  for (const BenchmarkRow& row : series.rows) curve.end_s = std::max(curve.end_s, row.timeout_s);
  curve.title = fmt::format("{}, {}: {}/{} solved", series.planner, short_label(series),
                            series.times.solved, series.valid);
  return curve;
}

/// Each improvement of a run lowers the curve by its share of the run's first path length.
Curve length_curve(const Series& series) {
  Curve curve{&series, 1, {}, 0, ""};
  int runs = 0;
  for (const BenchmarkRow& row : series.rows) {
    if (!is_success(row) || row.improvements.empty()) continue;
    ++runs;
    const double first = row.improvements.front().path_length;
    for (std::size_t i = 1; i < row.improvements.size() && first > 0; ++i) {
      const double gain = row.improvements[i - 1].path_length - row.improvements[i].path_length;
      curve.steps.push_back({row.improvements[i].time_s, gain / first});
    }
  }
  std::ranges::stable_sort(curve.steps, {}, &Step::seconds);
  double share = 1;
  for (Step& step : curve.steps) step.share = share -= step.share / runs;
  curve.title = fmt::format("{}, {}: {} runs, {:.1f} % of the first length at the end",
                            series.planner, short_label(series), runs, 100 * share);
  return curve;
}

}  // namespace

std::string solved_curves(const Panel& panel, const std::vector<std::string>& samplers) {
  std::vector<Curve> curves;
  for (const Series& series : panel.series) {
    if (series.valid > 0) curves.push_back(solved_curve(series));
  }
  return Curves(panel, samplers)
      .draw("Runs solved over time", "solved within the time", curves, 0, panel.longest_limit);
}

std::string length_curves(const Panel& panel, const std::vector<std::string>& samplers) {
  std::vector<Curve> curves;
  double lowest = 1, end_s = 0;
  for (const Series& series : panel.series) {
    Curve curve = length_curve(series);
    if (curve.steps.empty()) continue;
    lowest = std::min(lowest, curve.steps.back().share);
    end_s = std::max(end_s, curve.steps.back().seconds);
    curves.push_back(std::move(curve));
  }
  if (curves.empty()) return {};
  for (Curve& curve : curves) curve.end_s = end_s;
  // A multiple of 20 %, so that grid lines are at whole per cents.
  lowest = 0.2 * std::clamp(std::floor(lowest / 0.2), 0.0, 4.0);
  return Curves(panel, samplers)
      .draw("Mean path length over time", "mean length, time of improving", curves, lowest, end_s);
}

}  // namespace mneme::internal
