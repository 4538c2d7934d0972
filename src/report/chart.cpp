// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/chart.h"

#include "report/markup.h"
#include "report/svg_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace mneme::internal {
namespace {

constexpr double kWidth = 900;
constexpr double kPlannerColumn = 190;
constexpr double kSamplerColumn = 290;
constexpr double kPlotLeft = 380;
constexpr double kPlotRight = 820;
constexpr double kTop = 34;
constexpr double kRowHeight = 22;
constexpr double kProblemGap = 8;
constexpr double kBarHeight = 10;
constexpr double kShortest = 1e-6;  // seconds; a logarithm needs a positive number

double decade(double seconds) { return std::log10(std::max(seconds, kShortest)); }

/// Whole decades that hold all times.
struct TimeAxis {
  int first = 0;
  int last = 1;

  [[nodiscard]] double x(double seconds) const {
    return kPlotLeft + (kPlotRight - kPlotLeft) * (decade(seconds) - first) / (last - first);
  }
};

TimeAxis axis_of(std::span<const RunGroup> groups) {
  double least = decade(groups.front().times.p50);
  double most = least;
  for (const RunGroup& group : groups) {
    least = std::min(least, decade(group.times.p50));
    most = std::max({most, decade(group.times.p95), decade(group.times.max)});
  }
  const int first = static_cast<int>(std::floor(least));
  return {first, std::max(first + 1, static_cast<int>(std::ceil(most)))};
}

std::string decade_name(int power) {
  if (power >= 0) return fmt::format("{:.0f} s", std::pow(10.0, power));
  if (power >= -3) return fmt::format("{:.0f} ms", std::pow(10.0, power + 3));
  return fmt::format("{:.0f} \u00b5s", std::pow(10.0, power + 6));
}

void write_text(SvgWriter& svg, double x, double y, const std::string& anchor,
                const std::string& text) {
  svg.text_element("text",
                   {{"x", short_number(x)}, {"y", short_number(y)}, {"text-anchor", anchor}}, text);
}

void write_line(SvgWriter& svg, const std::string& kind, double x1, double y1, double x2,
                double y2) {
  svg.element("line", {{"class", kind},
                       {"x1", short_number(x1)},
                       {"y1", short_number(y1)},
                       {"x2", short_number(x2)},
                       {"y2", short_number(y2)}});
}

void write_axis(SvgWriter& svg, const TimeAxis& axis, double bottom) {
  for (int power = axis.first; power <= axis.last; ++power) {
    const double x = axis.x(std::pow(10.0, power));
    write_line(svg, "grid", x, kTop - 8, x, bottom);
    write_text(svg, x, kTop - 14, "middle", decade_name(power));
  }
}

void write_times(SvgWriter& svg, const TimeSummary& times, const TimeAxis& axis, double middle) {
  const double left = axis.x(times.p50);
  const double right = std::max(left + 2, axis.x(times.p95));
  const double end = axis.x(times.max);
  const double half = kBarHeight / 2;
  if (end > right) write_line(svg, "whisker", right, middle, end, middle);
  svg.element("rect", {{"class", is_censored(times, 95) ? "bar censored" : "bar"},
                       {"x", short_number(left)},
                       {"y", short_number(middle - half)},
                       {"width", short_number(right - left)},
                       {"height", short_number(kBarHeight)},
                       {"rx", "2"}});
  write_line(svg, "median", left, middle - half - 2, left, middle + half + 2);
  write_line(svg, is_censored(times, 100) ? "max censored" : "max", end, middle - half, end,
             middle + half);
}

void write_names(SvgWriter& svg, const RunGroup& group, bool is_new_problem, double middle) {
  const double baseline = middle + 4;
  if (is_new_problem)
    write_text(svg, 0, baseline, "start", shortened(single_line(group.problem), 25));
  write_text(svg, kPlannerColumn, baseline, "start", shortened(single_line(group.planner), 13));
  write_text(svg, kSamplerColumn, baseline, "start", shortened(single_line(group.sampler), 11));
  write_text(svg, kWidth, baseline, "end",
             fmt::format("{}/{}", group.times.solved, group.times.runs));
}

std::string spoken(const RunGroup& group) {
  return fmt::format("{}, {}, {}: p50 {} ms, p95 {} ms, p99 {} ms, max {} ms", group.problem,
                     group.planner, group.sampler, format_percentile(group.times, 50),
                     format_percentile(group.times, 95), format_percentile(group.times, 99),
                     format_percentile(group.times, 100));
}

std::string color_class(const std::string& sampler, std::vector<std::string>& samplers) {
  auto found = std::ranges::find(samplers, sampler);
  if (found == samplers.end()) found = samplers.insert(found, sampler);
  return fmt::format("row sampler-{}", (found - samplers.begin()) % kChartColors);
}

/// Vertical middle of each row; rows of one problem stand together.
std::vector<double> row_middles(std::span<const RunGroup> groups) {
  std::vector<double> middles;
  double y = kTop;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (i > 0 && groups[i].problem != groups[i - 1].problem) y += kProblemGap;
    middles.push_back(y + kRowHeight / 2);
    y += kRowHeight;
  }
  return middles;
}

}  // namespace

std::string time_chart(std::span<const RunGroup> groups) {
  if (groups.empty()) return {};
  const TimeAxis axis = axis_of(groups);
  const std::vector<double> middles = row_middles(groups);
  const double bottom = middles.back() + kRowHeight / 2 + 4;
  SvgWriter svg;
  svg.open("svg", {{"class", "chart"},
                   {"xmlns", "http://www.w3.org/2000/svg"},
                   {"viewBox", fmt::format("0 0 {} {}", kWidth, short_number(bottom))},
                   {"role", "img"},
                   {"aria-label", "Planning times on a logarithmic axis"}});
  write_axis(svg, axis, bottom);
  std::vector<std::string> samplers;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    svg.open("g", {{"class", color_class(groups[i].sampler, samplers)}});
    svg.text_element("title", {}, spoken(groups[i]));
    write_names(svg, groups[i], i == 0 || groups[i].problem != groups[i - 1].problem, middles[i]);
    write_times(svg, groups[i].times, axis, middles[i]);
    svg.close();
  }
  svg.close();
  return svg.str();
}

}  // namespace mneme::internal
