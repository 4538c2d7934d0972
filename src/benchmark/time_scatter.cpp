// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmark/figures.h"
#include "report/markup.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace mneme::internal {
namespace {

constexpr double kScatterWidth = 620;
constexpr double kScatterHeight = 470;
constexpr double kScatterSide = 380;
constexpr double kScatterLeft = 80;
constexpr double kScatterTop = 24;
constexpr double kScatterShortest = 1e-6;  // seconds

/// The medians of one problem and planner.
struct Dot {
  std::string problem, planner;
  double across = 0, up = 0;  ///< seconds
  bool is_open = false;       ///< the median run of one of them found no path
};

/// The median run's time; a run without a path stands at its limit, after all others.
struct MedianTime {
  double seconds = 0;
  bool is_failure = false;
};

MedianTime median_of(std::vector<const BenchmarkRow*> rows) {
  const auto rank = [](const BenchmarkRow* row) {
    return std::pair(!is_success(*row), is_success(*row) ? row->planning_time_s : row->timeout_s);
  };
  std::ranges::sort(rows, {}, rank);
  const auto [is_failure, seconds] = rank(rows[(rows.size() - 1) / 2]);
  return {std::max(seconds, kScatterShortest), is_failure};
}

std::vector<Dot> find_dots(std::span<const BenchmarkRow> rows, const std::string& sampler,
                           const std::string& baseline) {
  std::map<std::pair<std::string, std::string>,
           std::map<std::string, std::vector<const BenchmarkRow*>>>
      groups;
  for (const BenchmarkRow& row : rows) {
    if (!is_invalid_problem(row)) groups[{row.planner, row.problem}][row.sampler].push_back(&row);
  }
  std::vector<Dot> dots;
  for (const auto& [name, by_sampler] : groups) {
    const auto up = by_sampler.find(sampler), across = by_sampler.find(baseline);
    if (up == by_sampler.end() || across == by_sampler.end()) continue;
    const MedianTime x = median_of(across->second), y = median_of(up->second);
    dots.push_back({name.second, name.first, x.seconds, y.seconds, x.is_failure || y.is_failure});
  }
  return dots;
}

class Scatter {
 public:
  Scatter(std::vector<Dot> dots, std::string sampler, std::string baseline)
      : dots_(std::move(dots)),
        sampler_(std::move(sampler)),
        baseline_(std::move(baseline)),
        planners_(different(std::span<const Dot>(dots_), &Dot::planner)) {}

  std::string draw() {
    svg_.open("svg", {{"class", "plot scatter"},
                      {"xmlns", "http://www.w3.org/2000/svg"},
                      {"viewBox", fmt::format("0 0 {} {}", kScatterWidth, kScatterHeight)},
                      {"width", short_number(kScatterWidth)},
                      {"role", "img"},
                      {"aria-label", "Median planning times, one dot per problem"}});
    svg_.element("rect", {{"class", "paper"}, {"width", "100%"}, {"height", "100%"}});
    make_axis();
    draw_frame();
    for (const Dot& dot : dots_) draw_dot(dot);
    for (std::size_t i = 0; i < planners_.size(); ++i) draw_legend(i);
    svg_.close();
    return svg_.str();
  }

 private:
  void make_axis() {
    double least = dots_.front().across, most = least;
    for (const Dot& dot : dots_) {
      least = std::min({least, dot.across, dot.up});
      most = std::max({most, dot.across, dot.up});
    }
    axis_ = {least / 1.5, most * 1.5, 0, kScatterSide};
  }
  [[nodiscard]] double x_of(double seconds) const { return kScatterLeft + axis_.at(seconds); }
  [[nodiscard]] double y_of(double seconds) const {
    return kScatterTop + kScatterSide - axis_.at(seconds);
  }

  void draw_frame() {
    const double bottom = kScatterTop + kScatterSide, right = kScatterLeft + kScatterSide;
    for (const Tick& tick : ticks_of(axis_)) {
      const char* kind = tick.label.empty() ? "faint" : "grid";
      const double x = x_of(tick.seconds), y = y_of(tick.seconds);
      draw_line(svg_, kind, {x, kScatterTop}, {x, bottom});
      draw_line(svg_, kind, {kScatterLeft, y}, {right, y});
      if (tick.label.empty()) continue;
      draw_text(svg_, "soft", {x, bottom + 17}, "middle", tick.label);
      draw_text(svg_, "soft", {kScatterLeft - 7, y + 4}, "end", tick.label);
    }
    draw_line(svg_, "frame", {kScatterLeft, bottom}, {right, kScatterTop});
    draw_text(svg_, "label", {right, bottom + 42}, "end", baseline_ + ", median");
    draw_text(svg_, "label", {kScatterLeft, kScatterTop - 8}, "middle", sampler_ + ", median");
    draw_text(svg_, "soft", {right - 8, bottom - 10}, "end", "below the line: sooner from memory");
  }

  void draw_dot(const Dot& dot) {
    svg_.open("g", {{"class", color_class(dot.planner, planners_)}});
    svg_.text_element("title", {},
                      fmt::format("{}, {}: {} {}, {} {}{}", dot.problem, dot.planner, baseline_,
                                  format_duration(dot.across), sampler_, format_duration(dot.up),
                                  dot.is_open ? "; a median run found no path" : ""));
    svg_.element("circle", {{"class", dot.is_open ? "curve" : "dot"},
                            {"cx", short_number(x_of(dot.across))},
                            {"cy", short_number(y_of(dot.up))},
                            {"r", "5.5"}});
    svg_.close();
  }

  void draw_legend(std::size_t i) {
    const double x = kScatterLeft + kScatterSide + 24;
    const double y = kScatterTop + 20 + 22 * static_cast<double>(i);
    svg_.open("g", {{"class", color_class(planners_[i], planners_)}});
    svg_.element(
        "circle",
        {{"class", "dot"}, {"cx", short_number(x)}, {"cy", short_number(y - 4)}, {"r", "5.5"}});
    draw_text(svg_, "label", {x + 12, y}, "start", shortened(single_line(planners_[i]), 16));
    svg_.close();
  }

  std::vector<Dot> dots_;
  std::string sampler_, baseline_;
  std::vector<std::string> planners_;
  SvgWriter svg_;
  TimeAxis axis_;
};

}  // namespace

std::string time_scatter(std::span<const BenchmarkRow> rows, const std::string& sampler,
                         const std::string& baseline) {
  std::vector<Dot> dots = find_dots(rows, sampler, baseline);
  return dots.empty() ? "" : Scatter(std::move(dots), sampler, baseline).draw();
}

}  // namespace mneme::internal
