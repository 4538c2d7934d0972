// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The figures of a benchmark report, as SVG.
#pragma once

#include "statistics/panels.h"
#include "report/markup.h"

#include <string>
#include <vector>

namespace mneme::internal {

/// A logarithmic axis: times from `least` to `most` seconds on `length` pixels.
struct TimeAxis {
  double least = 1e-3;
  double most = 1;
  double length = 1;

  /// Position of a time; times outside of the axis are at its ends.
  [[nodiscard]] double at(double seconds) const;
};

struct Tick {
  double seconds = 0;
  std::string label;  ///< empty for minor ticks
};
/// Ticks at 1, 2, 5 of each decade. Powers of ten have labels; on short axes all ticks do.
[[nodiscard]] std::vector<Tick> ticks_of(const TimeAxis& axis);

/// "3 ms", "20 s", "150 µs".
[[nodiscard]] std::string format_duration(double seconds);

/// Opens a figure of class `kind`, with its size in pixels and an accessible `label`.
void open_figure(SvgWriter& svg, const std::string& kind, double width, double height,
                 const std::string& label);
void draw_line(SvgWriter& svg, const std::string& kind, Point from, Point to);
/// `anchor` is start, middle or end.
void draw_text(SvgWriter& svg, const std::string& kind, Point at, const std::string& anchor,
               const std::string& text);

/// The CSS class with the colour of a sampler, the same in all figures of a report.
[[nodiscard]] std::string color_class(const std::string& sampler,
                                      const std::vector<std::string>& samplers);
/// The dash pattern of a setting, by its position; "none" for the first.
[[nodiscard]] std::string dash_of(std::size_t setting);

/// CSS of all figures, for light and dark.
[[nodiscard]] const std::string& figure_style();
/// An SVG document: the figure with its style.
[[nodiscard]] std::string to_document(const std::string& figure);
inline constexpr int kFigureColors = 8;

/// An SVG figure of the share of runs solved over planning time: a diagram per planner, a curve per
/// series. Colours stand for samplers, dashes for settings.
[[nodiscard]] std::string solved_curves(const Panel& panel,
                                        const std::vector<std::string>& samplers);

/// An SVG figure of the mean path length while runs improve, as a share of the first path's, over
/// the time since improving began. Empty if no run was improved.
[[nodiscard]] std::string length_curves(const Panel& panel,
                                        const std::vector<std::string>& samplers);

/// An SVG figure of median planning times with `baseline` (x) and with `sampler` (y): one dot per
/// planner and panel. Below the diagonal `sampler` is faster. Medians that are failures are open
/// dots at the time limit. Empty if no planner ran with both.
[[nodiscard]] std::string difficulty_figure(const std::vector<Panel>& panels,
                                            const std::string& baseline,
                                            const std::string& sampler);

}  // namespace mneme::internal
