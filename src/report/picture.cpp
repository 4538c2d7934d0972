// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/report.h"

#include "report/drawing.h"
#include "report/markup.h"
#include "report/picture_labels.h"
#include "report/picture_layers.h"
#include "report/planar_view.h"
#include "report/svg_writer.h"

#include <fmt/format.h>

namespace mneme {
namespace internal {
namespace {

constexpr double kPictureWidth = 640;
constexpr double kSide = 12;  // pixels around the panel
constexpr double kTitleHeight = 38;

std::vector<LegendEntry> legend_of(const Drawing& drawing, bool has_path) {
  std::vector<LegendEntry> legend = {{LegendMark::bold_line, path_color(0), "start"}};
  if (has_path) legend.push_back({LegendMark::fan, "", "path"});
  legend.push_back({LegendMark::bold_line, std::string(kGoalColor), "goal"});
  const std::string color = primitive_color(drawing.primitives.size() == 1 ? 0 : kUniformOrigin);
  if (!drawing.memories.empty()) {
    legend.push_back({LegendMark::thin_lines, color, "remembered arms"});
  }
  if (!drawing.primitives.empty()) {
    legend.push_back({LegendMark::dashed_box, color, "primitive: matches, error"});
  }
  return legend;
}

/// Keeps labels off the base and the bold arms.
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

/// A nested document, because it clips without an identifier that pictures on one page would share.
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
  writer.write_frame_fills(drawing.primitives);
  writer.write_obstacles(drawing.obstacles);
  writer.write_frames(drawing.primitives);
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
}  // namespace internal

Result<std::string> to_svg(const PlanarPicture& picture) {
  using namespace internal;
  const Result<Drawing> drawing = make_drawing(picture);
  if (!drawing) return tl::unexpected(drawing.error());
  const double top = picture.title.empty() ? kSide : kTitleHeight;
  const PlanarView view(bounds_of(*drawing), {kSide, top}, kPictureWidth - 2 * kSide);
  const PixelBox panel = {kSide, top, kPictureWidth - kSide, top + view.height()};
  const std::vector<LegendEntry> legend = legend_of(*drawing, !picture.path.empty());
  const double legend_width = kPictureWidth - 2 * kSide;
  const double height = panel.bottom + 6 + legend_height(legend, legend_width) + 6;
  SvgWriter svg;
  open_document(svg, height, picture.title.empty() ? picture.problem->name : picture.title);
  if (!picture.title.empty()) write_title(svg, picture.title);
  write_panel(svg, *drawing, view, panel);
  write_legend(svg, legend, {kSide, panel.bottom + 6}, legend_width);
  svg.close();
  return svg.str();
}

}  // namespace mneme
