// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/picture_layers.h"

#include <algorithm>
#include <array>
#include <span>
#include <variant>

namespace mneme::internal {
namespace {

constexpr double kLabelSize = 11.5;
constexpr std::string_view kNeutralColor = "#6b7687";
constexpr std::array<std::string_view, 10> kPrimitiveColors = {
    "#c76a00", "#0b8a6a", "#8250df", "#bf2c86", "#0a7ea4",
    "#5f8416", "#8f5a2c", "#a8323e", "#4a5bb5", "#7a6a00"};

}  // namespace

std::string primitive_color(Origin origin) {
  if (origin < 0) return std::string(kNeutralColor);
  return std::string(kPrimitiveColors[static_cast<std::size_t>(origin) % kPrimitiveColors.size()]);
}

void PictureWriter::write_obstacles(const std::vector<Outline>& obstacles) {
  svg_.open("g", {{"class", "obstacles"},
                  {"fill", "#c9d4e3"},
                  {"stroke", "#8696ad"},
                  {"stroke-width", "1.1"}});
  for (const Outline& outline : obstacles) {
    if (const Disc* disc = std::get_if<Disc>(&outline)) {
      const Point center = view_.pixel(disc->center);
      svg_.element("circle", {{"cx", short_number(center.x)},
                              {"cy", short_number(center.y)},
                              {"r", short_number(disc->radius * view_.scale())}});
    } else {
      svg_.element("polygon", {{"points", short_points(view_.pixels(std::get<Polygon>(outline)))}});
    }
  }
  svg_.close();
}

void PictureWriter::write_frame_fills(const std::vector<FramedPrimitive>& primitives) {
  svg_.open("g", {{"class", "primitive-fills"}, {"fill-opacity", "0.08"}});
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    svg_.element("polygon", {{"points", short_points(view_.pixels(primitives[i].corners))},
                             {"fill", primitive_color(static_cast<Origin>(i))}});
  }
  svg_.close();
}

void PictureWriter::write_frames(const std::vector<FramedPrimitive>& primitives) {
  svg_.open("g", {{"class", "primitives"},
                  {"fill", "none"},
                  {"stroke-width", "1.4"},
                  {"stroke-dasharray", "6 4"},
                  {"stroke-linejoin", "round"}});
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    svg_.element("polygon", {{"points", short_points(view_.pixels(primitives[i].corners))},
                             {"stroke", primitive_color(static_cast<Origin>(i))}});
  }
  svg_.close();
}

void PictureWriter::write_lines(const Arm& arm, const std::string& color, double width,
                                double opacity) {
  for (const ArmLine& line : arm) {
    std::vector<Point> points = view_.pixels(line.points);
    if (points.size() == 1) points.push_back(points.front());
    const double true_width = 2 * line.radius * view_.scale();
    svg_.element("polyline", {{"points", short_points(points)},
                              {"stroke", color},
                              {"stroke-width", short_number(std::max(width, true_width))},
                              {"stroke-opacity", short_number(opacity)}});
  }
}

void PictureWriter::write_memories(const std::vector<RememberedArm>& memories) {
  svg_.open("g", {{"class", "memories"}, {"fill", "none"}, {"stroke-linejoin", "round"}});
  for (const RememberedArm& memory : memories) {
    write_lines(memory.arm, primitive_color(memory.origin), 0.7, 0.38);
  }
  svg_.close();
}

void PictureWriter::write_fan(const std::vector<Arm>& fan) {
  svg_.open("g", {{"class", "path"},
                  {"fill", "none"},
                  {"stroke-linejoin", "round"},
                  {"stroke-linecap", "round"}});
  for (std::size_t i = 0; i < fan.size(); ++i) {
    const double fraction = static_cast<double>(i + 1) / static_cast<double>(fan.size() + 1);
    write_lines(fan[i], path_color(fraction), 1.1, 0.45);
  }
  svg_.close();
}

void PictureWriter::write_tip_trace(const std::vector<Point>& trace) {
  constexpr std::size_t kChunk = 6;  // motions of one colour
  const std::vector<Point> points = view_.pixels(trace);
  svg_.open("g", {{"class", "tip-trace"},
                  {"fill", "none"},
                  {"stroke-width", "2"},
                  {"stroke-linejoin", "round"},
                  {"stroke-linecap", "round"}});
  for (std::size_t i = 0; i + 1 < points.size(); i += kChunk) {
    const std::size_t count = std::min(kChunk + 1, points.size() - i);
    const double fraction = static_cast<double>(i) / static_cast<double>(points.size() - 1);
    svg_.element("polyline", {{"points", short_points(std::span(points).subspan(i, count))},
                              {"stroke", path_color(fraction)}});
  }
  svg_.close();
}

void PictureWriter::write_bold_arm(const Arm& arm, std::string_view layer,
                                   const std::string& color) {
  svg_.open("g", {{"class", std::string(layer)},
                  {"fill", "none"},
                  {"stroke-linejoin", "round"},
                  {"stroke-linecap", "round"}});
  write_lines(arm, "#ffffff", 5.4, 0.85);
  write_lines(arm, color, 3.2, 1);
  for (const ArmLine& line : arm) {
    for (const Point& joint : view_.pixels(line.points)) {
      svg_.element("circle", {{"cx", short_number(joint.x)},
                              {"cy", short_number(joint.y)},
                              {"r", "2.6"},
                              {"fill", "#ffffff"},
                              {"stroke", color},
                              {"stroke-width", "1.4"}});
    }
  }
  svg_.close();
}

void PictureWriter::write_base(const Point& base) {
  const Point center = view_.pixel(base);
  svg_.element("rect", {{"class", "base"},
                        {"x", short_number(center.x - 6)},
                        {"y", short_number(center.y - 6)},
                        {"width", "12"},
                        {"height", "12"},
                        {"rx", "2"},
                        {"fill", "#1f2937"},
                        {"stroke", "#ffffff"},
                        {"stroke-width", "1.5"}});
}

void PictureWriter::write_labels(const std::vector<FramedPrimitive>& primitives,
                                 LabelPlacer placer) {
  svg_.open("g", {{"class", "labels"},
                  {"font-size", short_number(kLabelSize)},
                  {"font-weight", "600"},
                  {"text-anchor", "middle"},
                  {"stroke", "#fbfcfe"},
                  {"stroke-width", "3.5"},
                  {"stroke-linejoin", "round"},
                  {"paint-order", "stroke"}});
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    const std::vector<Point> corners = view_.pixels(primitives[i].corners);
    const double width = text_width(primitives[i].label, kLabelSize) + 6;
    const double height = kLabelSize + 5;
    const Point at = placer.place(label_places(corners, width, height), width, height);
    svg_.text_element("text",
                      {{"x", short_number(at.x)},
                       {"y", short_number(at.y + 0.36 * kLabelSize)},
                       {"fill", primitive_color(static_cast<Origin>(i))}},
                      primitives[i].label);
  }
  svg_.close();
}

}  // namespace mneme::internal
