// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The figures and tables of a benchmark report.
#pragma once

#include "statistics/panels.h"
#include "report/markup.h"

#include <span>
#include <string>
#include <vector>

namespace mneme::internal {

/// Times from `least` to `most` seconds along a line from `begin` to `end`.
struct TimeAxis {
  double least = 1e-3;
  double most = 1;
  double begin = 0;
  double end = 1;

  [[nodiscard]] double at(double seconds) const;
};

struct Tick {
  double seconds = 0;
  std::string label;  ///< empty for the small ones between
};
/// 1, 2, 5 of each decade: powers of ten have labels, on short axes the others too.
[[nodiscard]] std::vector<Tick> ticks_of(const TimeAxis& axis);

/// "3 ms", "20 s", "150 µs".
[[nodiscard]] std::string format_duration(double seconds);

/// Begins a figure of that size in pixels on its paper; `label` says what it shows.
void open_figure(SvgWriter& svg, const std::string& kind, double width, double height,
                 const std::string& label);
void draw_line(SvgWriter& svg, const std::string& kind, Point from, Point to);
/// `anchor` is start, middle or end.
void draw_text(SvgWriter& svg, const std::string& kind, Point at, const std::string& anchor,
               const std::string& text);

/// The class that gives a sampler its colour: the same in all figures of a report.
[[nodiscard]] std::string color_class(const std::string& sampler,
                                      const std::vector<std::string>& samplers);
/// The dash pattern of a setting, by its position; empty for the first.
[[nodiscard]] std::string dash_of(std::size_t setting);

/// Rules for all figures, light and dark.
[[nodiscard]] const std::string& figure_style();
/// A figure, which has no style of its own, as a document.
[[nodiscard]] std::string to_document(const std::string& figure);
inline constexpr int kFigureColors = 8;

/// An SVG figure: one box per series on a logarithmic axis, from the first to the third quartile
/// with the median, whiskers to the shortest and longest time, a dot per run, solved/total above,
/// and a cross at the limit for each time-out. Failures count as longer than any success; what they
/// leave open is dashed. `samplers` gives colours.
[[nodiscard]] std::string box_plot(const Panel& panel, const std::vector<std::string>& samplers);

/// An SVG figure: a diagram per planner, in it a curve per series, which rises at each planning
/// time of a success on a logarithmic axis. Colours tell samplers, dashes settings.
[[nodiscard]] std::string solved_curves(const Panel& panel,
                                        const std::vector<std::string>& samplers);

/// The same of the mean path length while runs improve, as a share of their first paths', on a
/// logarithmic axis of the time since improving began. Empty if nothing was improved.
[[nodiscard]] std::string length_curves(const Panel& panel,
                                        const std::vector<std::string>& samplers);

/// An SVG figure: one dot per planner and panel, at its median planning time with `baseline` across
/// and with `sampler` up, both logarithmic; below the diagonal `sampler` is faster. Medians of runs
/// without a path stand at their limit, as open dots. Colours tell planners. Empty if no planner
/// ran with both.
[[nodiscard]] std::string difficulty_figure(const std::vector<Panel>& panels,
                                            const std::string& baseline,
                                            const std::string& sampler);

/// One line per series: solved/valid/total, bad paths, p50, p95, p99, max. The attribute
/// `data-seconds` of each time has all its digits.
[[nodiscard]] std::string time_table(const Panel& panel);
/// One line per comparison; empty if there are none. Numbers with all digits are in `data-ratio`.
[[nodiscard]] std::string ratio_table(const std::vector<Comparison>& comparisons);
[[nodiscard]] std::string memory_table(std::span<const MemoryRow> memories);
/// What the settings' names stand for.
[[nodiscard]] std::string settings_table(std::span<const BenchmarkRow> rows);

}  // namespace mneme::internal
