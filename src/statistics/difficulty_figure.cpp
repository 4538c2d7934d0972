// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "statistics/figures.h"
#include "statistics/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace mneme::internal {
namespace {

constexpr double kDotSide = 420;
constexpr double kDotLeft = 84;
constexpr double kDotTop = 30;
constexpr double kDotRight = 190;
constexpr double kDotBottom = 56;
constexpr double kDotRadius = 5;
constexpr double kDotShortest = 1e-5;
constexpr double kDotLegendLine = 20;

/// Medians of one planner on one problem.
struct Dot {
  std::string planner;
  std::string problem;
  TimeSummary across, up;

  /// True if a median is a failure, at its time limit.
  [[nodiscard]] bool is_open() const { return is_censored(across, 50) || is_censored(up, 50); }
};

std::vector<Dot> dots_of(const std::vector<Panel>& panels, const std::string& baseline,
                         const std::string& sampler) {
  std::vector<Dot> dots;
  for (const Panel& panel : panels) {
    for (const Series& series : panel.series) {
      if (series.sampler != sampler || series.valid == 0) continue;
      const auto other = std::ranges::find_if(panel.series, [&](const Series& s) {
        return s.sampler == baseline && s.planner == series.planner &&
               s.setting == series.setting && s.valid > 0;
      });
      if (other == panel.series.end()) continue;
      dots.push_back({series.planner, panel.name, other->times, series.times});
    }
  }
  return dots;
}

class Scatter {
 public:
  Scatter(const std::vector<Dot>& dots, std::string across, std::string up)
      : dots_(dots), planners_(different(dots, &Dot::planner)) {
    double least = 1e9, most = 0;
    for (const Dot& dot : dots) {
      least = std::min({least, dot.across.p50, dot.up.p50});
      most = std::max({most, dot.across.p50, dot.up.p50});
    }
    least = std::max(least, kDotShortest);
    axis_ = {least / 1.5, std::max(most, 3 * least) * 1.5, kDotSide};
    across_ = std::move(across);
    up_ = std::move(up);
  }

  std::string draw() {
    const double width = kDotLeft + kDotSide + kDotRight, height = kDotTop + kDotSide + kDotBottom;
    open_figure(svg_, "plot", width, height, up_ + " against difficulty");
    draw_axes();
    for (const Dot& dot : dots_) draw_dot(dot);
    for (std::size_t i = 0; i < planners_.size(); ++i) draw_legend(i);
    svg_.close();
    return svg_.str();
  }

 private:
  [[nodiscard]] Point place(double across_s, double up_s) const {
    return {kDotLeft + axis_.at(across_s), kDotTop + kDotSide - axis_.at(up_s)};
  }

  void draw_axes() {
    const double right = kDotLeft + kDotSide, bottom = kDotTop + kDotSide;
    for (const Tick& tick : ticks_of(axis_)) {
      const Point at = place(tick.seconds, tick.seconds);
      const char* kind = tick.label.empty() ? "faint" : "grid";
      draw_line(svg_, kind, {at.x, kDotTop}, {at.x, bottom});
      draw_line(svg_, kind, {kDotLeft, at.y}, {right, at.y});
      if (tick.label.empty()) continue;
      draw_text(svg_, "soft", {at.x, bottom + 17}, "middle", tick.label);
      draw_text(svg_, "soft", {kDotLeft - 7, at.y + 4}, "end", tick.label);
    }
    draw_line(svg_, "limit", {kDotLeft, bottom}, {right, kDotTop});
    draw_text(svg_, "soft", {right - 8, kDotTop + 34}, "end", "as long");
    draw_text(svg_, "label", {right, bottom + 42}, "end", across_ + ", median");
    draw_text(svg_, "label", {kDotLeft - 60, kDotTop - 12}, "start", up_ + ", median");
  }

  void draw_dot(const Dot& dot) {
    const Point at = place(dot.across.p50, dot.up.p50);
    svg_.open("g", {{"class", color_class(dot.planner, planners_)}});
    svg_.text_element("title", {},
                      fmt::format("{}, {}: {} {}{}, {} {}{}", dot.problem, dot.planner, across_,
                                  mark(dot.across), format_duration(dot.across.p50), up_,
                                  mark(dot.up), format_duration(dot.up.p50)));
    svg_.element("circle", {{"class", dot.is_open() ? "box open" : "run"},
                            {"cx", short_number(at.x)},
                            {"cy", short_number(at.y)},
                            {"r", short_number(kDotRadius)}});
    svg_.close();
  }

  static const char* mark(const TimeSummary& times) { return is_censored(times, 50) ? "> " : ""; }

  void draw_legend(std::size_t i) {
    const double x = kDotLeft + kDotSide + 24;
    const double y = kDotTop + 20 + kDotLegendLine * static_cast<double>(i);
    svg_.open("g", {{"class", "legend " + color_class(planners_[i], planners_)}});
    svg_.element("circle", {{"class", "run"},
                            {"cx", short_number(x)},
                            {"cy", short_number(y - 4)},
                            {"r", short_number(kDotRadius)}});
    draw_text(svg_, "label", {x + 14, y}, "start", shortened(single_line(planners_[i]), 22));
    svg_.close();
  }

  const std::vector<Dot>& dots_;
  std::vector<std::string> planners_;
  std::string across_, up_;
  TimeAxis axis_;
  SvgWriter svg_;
};

}  // namespace

std::string difficulty_figure(const std::vector<Panel>& panels, const std::string& baseline,
                              const std::string& sampler) {
  const std::vector<Dot> dots = dots_of(panels, baseline, sampler);
  if (dots.empty()) return "";
  return Scatter(dots, single_line(baseline), single_line(sampler)).draw();
}

}  // namespace mneme::internal
