// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/picture.h"

#include "mneme/report.h"

#include "report/markup.h"

#include <fmt/format.h>

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

constexpr double kPictureWidth = 640;
constexpr double kSide = 12;  // pixels around the panel
constexpr double kTitleHeight = 38;

std::vector<LegendEntry> legend_of(const Drawing& drawing, bool has_path) {
  std::vector<LegendEntry> legend = {{LegendMark::bold_line, path_color(0), "start"}};
  if (has_path) legend.push_back({LegendMark::fan, "", "path"});
  legend.push_back({LegendMark::bold_line, std::string(kGoalColor), "goal"});
  const std::string color = primitive_color(drawing.primitives.size() == 1 ? 0 : kUniformSource);
  if (!drawing.memories.empty()) {
    legend.push_back({LegendMark::thin_lines, color, "remembered arms"});
  }
  if (!drawing.primitives.empty()) {
    legend.push_back({LegendMark::dashed_box, color, "primitive: matches, error"});
  }
  return legend;
}

/// Returns a placer that keeps labels off the base, the scale bar and the bold arms.
LabelPlacer make_placer(const Drawing& drawing, const PlanarView& view, const PixelBox& panel) {
  LabelPlacer placer({panel.left + 4, panel.top + 4, panel.right - 4, panel.bottom - 4});
  const Point base = view.pixel(drawing.base);
  placer.avoid({base.x - 9, base.y - 9, base.x + 9, base.y + 9});
  placer.avoid({panel.right - 20 - view.scale(), panel.bottom - 32, panel.right, panel.bottom});
  std::vector<Arm> arms = drawing.goals;
  arms.push_back(drawing.start);
  for (const Arm& arm : arms) {
    for (const ArmLine& line : arm) placer.avoid_line(view.pixels(line.points));
  }
  return placer;
}

void open_document(SvgWriter& svg, double height, const std::string& title) {
  svg.open("svg", {{"xmlns", "http://www.w3.org/2000/svg"},
                   {"width", short_number(kPictureWidth)},
                   {"height", short_number(height)},
                   {"viewBox", fmt::format("0 0 {} {}", kPictureWidth, short_number(height))},
                   {"font-family", std::string(kFontFamily)},
                   {"role", "img"}});
  svg.text_element("title", {}, title);
  svg.element("rect", {{"class", "background"},
                       {"width", short_number(kPictureWidth)},
                       {"height", short_number(height)},
                       {"rx", "10"},
                       {"fill", "#ffffff"}});
}

void write_title(SvgWriter& svg, const std::string& title) {
  svg.text_element("text",
                   {{"class", "title"},
                    {"x", short_number(kSide + 2)},
                    {"y", "25"},
                    {"font-size", "15"},
                    {"font-weight", "600"},
                    {"fill", "#1f2937"}},
                   shortened(single_line(title), 72));
}

void write_scale_bar(SvgWriter& svg, const PlanarView& view, const PixelBox& panel) {
  const double right = panel.right - 12;
  const double y = panel.bottom - 12;
  svg.open("g", {{"class", "scale"}, {"stroke", "#6b7687"}, {"fill", "none"}});
  svg.element("path", {{"d", fmt::format("M{} {}v-5v5h{}v-5", short_number(right - view.scale()),
                                         short_number(y), short_number(view.scale()))}});
  svg.text_element("text",
                   {{"x", short_number(right - view.scale() / 2)},
                    {"y", short_number(y - 4)},
                    {"font-size", "11"},
                    {"fill", "#6b7687"},
                    {"stroke", "none"},
                    {"text-anchor", "middle"}},
                   "1 m");
  svg.close();
}

/// Opens a nested document, which clips without an identifier; identifiers clash between pictures
/// on one page.
void open_panel(SvgWriter& svg, const PixelBox& panel) {
  const std::string x = short_number(panel.left);
  const std::string y = short_number(panel.top);
  const std::string width = short_number(panel.right - panel.left);
  const std::string height = short_number(panel.bottom - panel.top);
  svg.open("svg", {{"class", "panel"},
                   {"x", x},
                   {"y", y},
                   {"width", width},
                   {"height", height},
                   {"viewBox", fmt::format("{} {} {} {}", x, y, width, height)}});
  svg.element("rect",
              {{"x", x}, {"y", y}, {"width", width}, {"height", height}, {"fill", "#f7f9fc"}});
}

void write_panel(SvgWriter& svg, const Drawing& drawing, const PlanarView& view,
                 const PixelBox& panel) {
  PictureWriter writer(svg, view);
  open_panel(svg, panel);
  writer.write_frames(drawing.primitives, "fill",
                      {{"class", "primitive-fills"}, {"fill-opacity", "0.08"}});
  writer.write_obstacles(drawing.obstacles);
  writer.write_frames(drawing.primitives, "stroke",
                      {{"class", "primitives"},
                       {"fill", "none"},
                       {"stroke-width", "1.4"},
                       {"stroke-dasharray", "6 4"},
                       {"stroke-linejoin", "round"}});
  writer.write_memories(drawing.memories);
  writer.write_fan(drawing.fan);
  writer.write_tip_trace(drawing.tip_trace);
  for (const Arm& goal : drawing.goals)
    writer.write_bold_arm(goal, "goal", std::string(kGoalColor));
  writer.write_bold_arm(drawing.start, "start", path_color(0));
  writer.write_base(drawing.base);
  write_scale_bar(svg, view, panel);
  writer.write_labels(drawing.primitives, make_placer(drawing, view, panel));
  svg.close();
}

}  // namespace

std::string primitive_color(SampleSource source) {
  if (source < 0) return std::string(kNeutralColor);
  return std::string(kPrimitiveColors[static_cast<std::size_t>(source) % kPrimitiveColors.size()]);
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

void PictureWriter::write_frames(const std::vector<FramedPrimitive>& primitives,
                                 std::string_view paint, Attributes group) {
  svg_.open("g", group);
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    svg_.element("polygon", {{"points", short_points(view_.pixels(primitives[i].corners))},
                             {paint, primitive_color(static_cast<SampleSource>(i))}});
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
    write_lines(memory.arm, primitive_color(memory.source), 0.7, 0.38);
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
                       {"fill", primitive_color(static_cast<SampleSource>(i))}},
                      primitives[i].label);
  }
  svg_.close();
}

}  // namespace mneme::internal

namespace mneme {

PlanarPicture make_picture(const Problem& problem, const SolveResult& result) {
  PlanarPicture picture;
  picture.problem = &problem;
  picture.gl = &result.gl;
  picture.path = result.plan.path;
  picture.title =
      fmt::format("{}: {} with sampler {}, {} in {:.2f} ms", problem.name, result.planner,
                  result.sampler, to_string(result.plan.status), 1e3 * result.planning_time_s);
  return picture;
}

Result<std::string> to_svg(const PlanarPicture& picture) {
  using namespace internal;
  const Drawing drawing = MNEME_TRY(make_drawing(picture));
  const double top = picture.title.empty() ? kSide : kTitleHeight;
  const PlanarView view(bounds_of(drawing), {kSide, top}, kPictureWidth - 2 * kSide);
  const PixelBox panel = {kSide, top, kPictureWidth - kSide, top + view.height()};
  const std::vector<LegendEntry> legend = legend_of(drawing, !picture.path.empty());
  const double legend_width = kPictureWidth - 2 * kSide;
  const double height = panel.bottom + 6 + legend_height(legend, legend_width) + 6;
  SvgWriter svg;
  open_document(svg, height, picture.title.empty() ? picture.problem->name : picture.title);
  if (!picture.title.empty()) write_title(svg, picture.title);
  write_panel(svg, drawing, view, panel);
  write_legend(svg, legend, {kSide, panel.bottom + 6}, legend_width);
  svg.close();
  return svg.str();
}

}  // namespace mneme
