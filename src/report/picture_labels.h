// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The words of a picture: labels that avoid each other, and the legend.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "report/svg_writer.h"

namespace mneme::internal {

inline constexpr std::string_view kFontFamily =
    "Inter, 'Helvetica Neue', Helvetica, Arial, 'DejaVu Sans', sans-serif";

/// A rough width of `text` in pixels; fonts differ between viewers.
[[nodiscard]] double text_width(std::string_view text, double font_size);

/// An axis-aligned rectangle in pixels.
struct PixelBox {
  double left = 0, top = 0, right = 0, bottom = 0;
};
[[nodiscard]] double overlap_area(const PixelBox& a, const PixelBox& b);

/// Finds places for labels, one after the other.
class LabelPlacer {
 public:
  explicit LabelPlacer(const PixelBox& panel) : panel_(panel) {}
  /// Keeps later labels off `box` if there is a better place.
  void avoid(const PixelBox& box) { taken_.push_back(box); }
  /// The same of a line of pixels.
  void avoid_line(std::span<const Point> points);
  /// The centre, among `candidates` (not empty, best first), of the place for a label of that size
  /// that covers least of what is taken and sticks out of the panel least. The place is taken then.
  Point place(std::span<const Point> candidates, double width, double height);

 private:
  PixelBox panel_;
  std::vector<PixelBox> taken_;
  std::vector<PixelBox> labels_;
};

/// Centres of places for a label around a convex polygon of pixels, whichever way round it goes.
[[nodiscard]] std::vector<Point> label_places(std::span<const Point> corners, double width,
                                              double height);

enum class LegendMark { bold_line, fan, dashed_box, thin_lines };

struct LegendEntry {
  LegendMark mark = LegendMark::bold_line;
  std::string color;  ///< of the mark, where it has one colour
  std::string words;
};
/// Colour of the path at `fraction` of it: blue at the start, red at the goal.
[[nodiscard]] std::string path_color(double fraction);

/// Height of the legend in pixels when its entries flow in rows of `width`.
[[nodiscard]] double legend_height(std::span<const LegendEntry> entries, double width);
void write_legend(SvgWriter& svg, std::span<const LegendEntry> entries, const Point& corner,
                  double width);

}  // namespace mneme::internal
