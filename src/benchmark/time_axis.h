// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Logarithmic axes of time, and the pieces that all figures of a report are made of.
#pragma once

#include <string>
#include <vector>

#include "report/svg_writer.h"

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

}  // namespace mneme::internal
