// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/markup.h"
#include "report/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace mneme::internal {
namespace {

constexpr double kFontSize = 12;
constexpr double kLegendRowHeight = 20;
constexpr double kMarkWidth = 26;
constexpr double kMarkGap = 7;
constexpr double kEntryGap = 20;
// Costs per square pixel; covering a taken area costs 1.
constexpr double kOutsideCost = 8;
constexpr double kLabelOverlapCost = 8;

double entry_width(const LegendEntry& entry) {
  return kMarkWidth + kMarkGap + text_width(entry.words, kFontSize);
}

/// Returns the top left corners of the entries relative to the legend.
std::vector<Point> entry_corners(std::span<const LegendEntry> entries, double width) {
  std::vector<Point> corners;
  Point next;
  for (const LegendEntry& entry : entries) {
    const double right = next.x + entry_width(entry);
    if (next.x > 0 && right > width) next = {0, next.y + kLegendRowHeight};
    corners.push_back(next);
    next.x += entry_width(entry) + kEntryGap;
  }
  return corners;
}

void write_line(SvgWriter& svg, const Point& a, const Point& b, const std::string& color,
                const std::string& stroke_width, const std::string& opacity = "1") {
  svg.element("line", {{"x1", short_number(a.x)},
                       {"y1", short_number(a.y)},
                       {"x2", short_number(b.x)},
                       {"y2", short_number(b.y)},
                       {"stroke", color},
                       {"stroke-width", stroke_width},
                       {"stroke-opacity", opacity},
                       {"stroke-linecap", "round"}});
}

/// Writes lines that spread from the lower middle of the mark.
void write_fan(SvgWriter& svg, const Point& corner) {
  constexpr int kLines = 9;
  const Point foot = {corner.x + kMarkWidth / 2, corner.y + 15};
  for (int i = 0; i < kLines; ++i) {
    const double fraction = i / (kLines - 1.0);
    const double angle = 2.7 - 2.26 * fraction;
    write_line(svg, foot, {foot.x + 12.5 * std::cos(angle), foot.y - 12.5 * std::sin(angle)},
               path_color(fraction), "1.2", "0.8");
  }
}

void write_mark(SvgWriter& svg, const LegendEntry& entry, const Point& corner) {
  const double middle = corner.y + kLegendRowHeight / 2 - 1;
  switch (entry.mark) {
    case LegendMark::bold_line:
      write_line(svg, {corner.x + 2, middle}, {corner.x + kMarkWidth - 2, middle}, entry.color,
                 "3");
      break;
    case LegendMark::fan:
      write_fan(svg, corner);
      break;
    case LegendMark::dashed_box:
      svg.element("path",
                  {{"d", fmt::format("M{} {}h{}v13h-{}z", short_number(corner.x + 2),
                                     short_number(middle - 6.5), kMarkWidth - 4, kMarkWidth - 4)},
                   {"fill", entry.color},
                   {"fill-opacity", "0.12"},
                   {"stroke", entry.color},
                   {"stroke-width", "1.3"},
                   {"stroke-dasharray", "4 2.5"}});
      break;
    case LegendMark::thin_lines:
      for (const double y : {-3.5, 0.0, 3.5}) {
        write_line(svg, {corner.x + 2, middle + y + 1}, {corner.x + kMarkWidth - 2, middle - y},
                   entry.color, "0.9", "0.8");
      }
      break;
  }
}

}  // namespace

double text_width(std::string_view text, double font_size) {
  return 0.57 * font_size * character_count(text);
}

double overlap_area(const PixelBox& a, const PixelBox& b) {
  const double width = std::min(a.right, b.right) - std::max(a.left, b.left);
  const double height = std::min(a.bottom, b.bottom) - std::max(a.top, b.top);
  return std::max(0.0, width) * std::max(0.0, height);
}

void LabelPlacer::avoid_line(std::span<const Point> points) {
  constexpr double kStep = 6;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Point delta = {points[i].x - points[i - 1].x, points[i].y - points[i - 1].y};
    const int steps = std::max(1, static_cast<int>(std::hypot(delta.x, delta.y) / kStep));
    for (int k = 0; k < steps; ++k) {
      const double fraction = (k + 0.5) / steps;
      const Point at = {points[i - 1].x + fraction * delta.x, points[i - 1].y + fraction * delta.y};
      avoid({at.x - kStep / 2, at.y - kStep / 2, at.x + kStep / 2, at.y + kStep / 2});
    }
  }
}

std::vector<Point> label_places(std::span<const Point> corners, double width, double height) {
  constexpr double kClearance = 2;
  Point middle;
  for (const Point& corner : corners) {
    middle.x += corner.x / static_cast<double>(corners.size());
    middle.y += corner.y / static_cast<double>(corners.size());
  }
  std::vector<Point> places;
  for (const double along : {0.5, 0.3, 0.7, 0.1, 0.9}) {
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Point& a = corners[i];
      const Point& b = corners[(i + 1) % corners.size()];
      const double length = std::max(1e-9, std::hypot(b.x - a.x, b.y - a.y));
      Point out = {(b.y - a.y) / length, (a.x - b.x) / length};
      if (out.x * (middle.x - a.x) + out.y * (middle.y - a.y) > 0) out = {-out.x, -out.y};
      const double away = kClearance + std::abs(out.x) * width / 2 + std::abs(out.y) * height / 2;
      places.push_back(
          {a.x + along * (b.x - a.x) + away * out.x, a.y + along * (b.y - a.y) + away * out.y});
    }
  }
  return places;
}

Point LabelPlacer::place(std::span<const Point> candidates, double width, double height) {
  const auto box_at = [&](const Point& center) -> PixelBox {
    return {center.x - width / 2, center.y - height / 2, center.x + width / 2,
            center.y + height / 2};
  };
  Point best = candidates.front();
  double least = std::numeric_limits<double>::infinity();
  for (const Point& candidate : candidates) {
    const PixelBox box = box_at(candidate);
    double cost = kOutsideCost * (width * height - overlap_area(box, panel_));
    for (const PixelBox& other : taken_) cost += overlap_area(box, other);
    for (const PixelBox& label : labels_) cost += kLabelOverlapCost * overlap_area(box, label);
    if (cost < least) {
      least = cost;
      best = candidate;
    }
  }
  labels_.push_back(box_at(best));
  return best;
}

std::string path_color(double fraction) {
  using Rgb = std::array<double, 3>;
  constexpr Rgb kStart = {31, 95, 208};
  constexpr Rgb kMiddle = {150, 74, 170};
  constexpr Rgb kGoal = {217, 48, 58};
  const bool is_first_half = fraction < 0.5;
  const Rgb& from = is_first_half ? kStart : kMiddle;
  const Rgb& to = is_first_half ? kMiddle : kGoal;
  const double share = std::clamp(is_first_half ? 2 * fraction : 2 * fraction - 1, 0.0, 1.0);
  std::array<int, 3> mix{};
  for (std::size_t i = 0; i < 3; ++i) {
    mix[i] = static_cast<int>(std::lround(from[i] + share * (to[i] - from[i])));
  }
  return fmt::format("#{:02x}{:02x}{:02x}", mix[0], mix[1], mix[2]);
}

double legend_height(std::span<const LegendEntry> entries, double width) {
  return entries.empty() ? 0 : entry_corners(entries, width).back().y + kLegendRowHeight;
}

void write_legend(SvgWriter& svg, std::span<const LegendEntry> entries, const Point& corner,
                  double width) {
  const std::vector<Point> corners = entry_corners(entries, width);
  svg.open("g", {{"class", "legend"}, {"font-size", short_number(kFontSize)}, {"fill", "#3a4657"}});
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const Point at = {corner.x + corners[i].x, corner.y + corners[i].y};
    write_mark(svg, entries[i], at);
    svg.text_element("text",
                     {{"x", short_number(at.x + kMarkWidth + kMarkGap)},
                      {"y", short_number(at.y + kLegendRowHeight / 2 + 3.5)}},
                     entries[i].words);
  }
  svg.close();
}

}  // namespace mneme::internal
