// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "statistics/figures.h"
#include "statistics/summary.h"
#include "report/markup.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mneme::internal {
namespace {

constexpr double kLeft = 84;
constexpr double kRight = 16;
constexpr double kTop = 58;
constexpr double kPlotHeight = 300;
constexpr double kGap = 26;  // between planners
constexpr double kMinPitch = 44;
constexpr double kMaxPitch = 92;
constexpr double kWidth = 960;
constexpr int kLabelLength = 30;
constexpr int kNameLength = 24;
constexpr double kLabelAngle = 38;  // degrees
constexpr double kCharacter = 6.2;  // pixels, about
constexpr double kShortest = 1e-6;  // seconds
constexpr int kFailureRows = 3;
constexpr double kCrossPitch = 8;

struct Place {
  double x = 0;     ///< middle of the box
  double half = 0;  ///< of its width
};

class BoxPlot {
 public:
  BoxPlot(const Panel& panel, const std::vector<std::string>& samplers)
      : panel_(panel), samplers_(samplers) {
    place_boxes();
    make_axis();
  }

  std::string draw() {
    const double bottom = kTop + kPlotHeight;
    const double height = bottom + label_height() + 34;
    open_figure(svg_, "plot boxes", width_, height,
                "Planning times of " + single_line(panel_.name));
    draw_axis(bottom);
    for (std::size_t i = 0; i < places_.size(); ++i)
      draw_series(panel_.series[i], places_[i], bottom);
    draw_planners(height);
    svg_.close();
    return svg_.str();
  }

 private:
  void place_boxes() {
    const auto count = static_cast<double>(panel_.series.size());
    double gaps = 0;
    for (std::size_t i = 1; i < panel_.series.size(); ++i) gaps += is_first(i) ? kGap : 0;
    const double room = kWidth - kLeft - kRight - gaps;
    const double pitch = std::clamp(room / std::max(count, 1.0), kMinPitch, kMaxPitch);
    double x = kLeft + 10;
    for (std::size_t i = 0; i < panel_.series.size();) {
      const std::size_t end = group_end(i);
      const double boxes = pitch * static_cast<double>(end - i);
      const double margin = std::max(0.0, (name_width(panel_.series[i].planner) - boxes) / 2);
      for (x += margin; i < end; ++i, x += pitch) {
        places_.push_back({x + pitch / 2, std::min(pitch * 0.3, 17.0)});
      }
      x += margin + kGap;
    }
    width_ = std::max(x - kGap + kRight, 520.0);
  }

  /// Behind the last series of the planner whose first is `begin`.
  [[nodiscard]] std::size_t group_end(std::size_t begin) const {
    std::size_t end = begin + 1;
    while (end < panel_.series.size() && !is_first(end)) ++end;
    return end;
  }

  static double name_width(const std::string& planner) {
    constexpr double kHeadCharacter = 7.6;
    return kHeadCharacter * std::min(character_count(single_line(planner)), kNameLength);
  }

  [[nodiscard]] bool is_first(std::size_t i) const {
    return i == 0 || panel_.series[i].planner != panel_.series[i - 1].planner;
  }

  void make_axis() {
    double least = panel_.longest_limit > 0 ? panel_.longest_limit : 1;
    double most = kShortest;
    for (const Series& series : panel_.series) {
      if (!series.solved_times.empty()) {
        least = std::min(least, series.solved_times.front());
        most = std::max(most, series.solved_times.back());
      }
      if (!series.limits.empty()) most = std::max(most, series.limits.back());
    }
    least = std::max(least, kShortest);
    const double room = has_failures() ? kFailureRows * kCrossPitch : 0;
    most = std::max(most, 3 * least) * (has_failures() ? 1 : 1.25);
    axis_ = {least / 1.5, most, kTop + kPlotHeight, kTop + room};
  }

  [[nodiscard]] bool has_failures() const {
    return std::ranges::any_of(panel_.series, [](const Series& s) { return !s.limits.empty(); });
  }

  [[nodiscard]] double label_height() const {
    int longest = 0;
    for (const Series& series : panel_.series) {
      longest = std::max(longest, character_count(shortened(short_label(series), kLabelLength)));
    }
    return 16 + std::sin(kLabelAngle * 3.14159265 / 180) * kCharacter * longest;
  }

  void draw_axis(double bottom) {
    draw_text(svg_, "head", {kLeft - 68, 20}, "start", single_line(panel_.name));
    draw_text(svg_, "soft", {width_ - kRight, 20}, "end", "planning time, retrieval included");
    for (const Tick& tick : ticks_of(axis_)) {
      const double y = axis_.at(tick.seconds);
      draw_line(svg_, tick.label.empty() ? "faint" : "grid", {kLeft, y}, {width_ - kRight, y});
      if (!tick.label.empty()) draw_text(svg_, "soft", {kLeft - 8, y + 4}, "end", tick.label);
    }
    draw_line(svg_, "frame", {kLeft, bottom}, {width_ - kRight, bottom});
    if (!has_failures()) return;
    const double y = axis_.at(panel_.longest_limit);
    draw_line(svg_, "limit", {kLeft, y}, {width_ - kRight, y});
    draw_text(svg_, "bad", {kLeft - 8, y - 8}, "end",
              "limit " + format_duration(panel_.longest_limit));
  }

  void draw_series(const Series& series, const Place& place, double bottom) {
    svg_.open("g", {{"class", "series " + color_class(series.sampler, samplers_)}});
    const TimeSummary& times = series.summary.times;
    svg_.text_element(
        "title", {},
        fmt::format("{}, {}: {}/{} solved, p50 {} ms, p95 {} ms, max {} ms", series.planner,
                    short_label(series), times.solved, times.runs, format_percentile(times, 50),
                    format_percentile(times, 95), format_percentile(times, 100)));
    draw_text(svg_, times.solved < times.runs ? "solved bad" : "solved", {place.x, kTop - 12},
              "middle", fmt::format("{}/{}", times.solved, times.runs));
    if (times.solved > 0) draw_box(times, series.solved_times, place);
    draw_runs(series, place);
    svg_.text_element(
        "text",
        {{"class", "label"},
         {"text-anchor", "end"},
         {"transform", fmt::format("translate({} {}) rotate({})", short_number(place.x + 4),
                                   short_number(bottom + 16), short_number(-kLabelAngle))}},
        shortened(short_label(series), kLabelLength));
    svg_.close();
  }

  void draw_box(const TimeSummary& times, const std::vector<double>& solved, const Place& place) {
    const double low = axis_.at(times.p25), high = axis_.at(times.p75);
    const double left = place.x - place.half;
    if (!is_censored(times, 25)) {
      svg_.element("rect", {{"class", is_censored(times, 75) ? "box open" : "box"},
                            {"x", short_number(left)},
                            {"y", short_number(high)},
                            {"width", short_number(2 * place.half)},
                            {"height", short_number(std::max(low - high, 1.0))},
                            {"rx", "2"}});
    }
    draw_whisker(axis_.at(solved.front()), is_censored(times, 25) ? high : low, place, false);
    if (axis_.at(times.max) < high) {
      draw_whisker(axis_.at(times.max), high, place, is_censored(times, 100));
    }
    if (is_censored(times, 50)) return;
    const double middle = axis_.at(times.p50);
    draw_line(svg_, "median", {left, middle}, {left + 2 * place.half, middle});
  }

  void draw_whisker(double end, double box, const Place& place, bool is_open) {
    const std::string kind = is_open ? "whisker open" : "whisker";
    draw_line(svg_, kind, {place.x, box}, {place.x, end});
    const double half = place.half / 2;
    if (!is_open) draw_line(svg_, kind, {place.x - half, end}, {place.x + half, end});
  }

  /// Dots spread sideways, so that equal times can be told apart.
  void draw_runs(const Series& series, const Place& place) {
    constexpr std::size_t kMostDots = 200;
    constexpr double kGolden = 0.618033988749895;
    const auto& times = series.solved_times;
    const std::size_t step = std::max<std::size_t>(1, times.size() / kMostDots);
    for (std::size_t i = 0; i < times.size(); i += step) {
      const double side = std::fmod(kGolden * static_cast<double>(i + 1), 1.0) - 0.5;
      svg_.element("circle", {{"class", "run"},
                              {"cx", short_number(place.x + side * 1.5 * place.half)},
                              {"cy", short_number(axis_.at(times[i]))},
                              {"r", "1.8"}});
    }
    draw_failures(series, place);
  }

  /// Crosses at the limit, in rows above each other if there are many.
  void draw_failures(const Series& series, const Place& place) {
    const std::size_t count = series.limits.size();
    const std::size_t columns = (count + kFailureRows - 1) / kFailureRows;
    const double pitch = std::min(kCrossPitch, 3 * place.half / static_cast<double>(columns));
    for (std::size_t i = 0; i < count; ++i) {
      const auto row = static_cast<double>(i / columns);
      const std::size_t in_row = std::min(columns, count - i / columns * columns);
      const double column = static_cast<double>(i % columns) - static_cast<double>(in_row - 1) / 2;
      draw_cross({place.x + column * pitch, axis_.at(series.limits[i]) - kCrossPitch * row});
    }
  }

  void draw_cross(Point at) {
    constexpr double kArm = 2.8;
    svg_.element("path",
                 {{"class", "out"},
                  {"d", fmt::format("M{0} {1}l{2} {2}m0 -{2}l-{2} {2}", short_number(at.x - kArm),
                                    short_number(at.y - kArm), 2 * kArm)}});
  }

  void draw_planners(double height) {
    for (std::size_t i = 0; i < places_.size();) {
      const std::size_t last = group_end(i) - 1;
      const double y = height - 26;
      const double left = places_[i].x - 18, right = places_[last].x + 18;
      draw_line(svg_, "frame", {left, y}, {right, y});
      draw_text(svg_, "head", {(left + right) / 2, y + 18}, "middle",
                shortened(single_line(panel_.series[i].planner), kNameLength));
      i = last + 1;
    }
  }

  const Panel& panel_;
  const std::vector<std::string>& samplers_;
  SvgWriter svg_;
  std::vector<Place> places_;
  TimeAxis axis_;
  double width_ = kWidth;
};

}  // namespace

std::string box_plot(const Panel& panel, const std::vector<std::string>& samplers) {
  return BoxPlot(panel, samplers).draw();
}

}  // namespace mneme::internal
