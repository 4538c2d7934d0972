// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The layers of a planar picture, each a group of its own class.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "report/drawing.h"
#include "report/picture_labels.h"
#include "report/planar_view.h"
#include "report/svg_writer.h"

namespace mneme::internal {

inline constexpr std::string_view kGoalColor = "#d9303a";
/// Colours repeat after ten primitives; kUniformOrigin is grey.
[[nodiscard]] std::string primitive_color(Origin origin);

/// Writes the layers of a drawing, from the back to the front.
class PictureWriter {
 public:
  PictureWriter(SvgWriter& svg, const PlanarView& view) : svg_(svg), view_(view) {}

  void write_obstacles(const std::vector<Outline>& obstacles);
  void write_frame_fills(const std::vector<FramedPrimitive>& primitives);
  void write_frames(const std::vector<FramedPrimitive>& primitives);
  void write_memories(const std::vector<RememberedArm>& memories);
  void write_fan(const std::vector<Arm>& fan);
  void write_tip_trace(const std::vector<Point>& trace);
  void write_bold_arm(const Arm& arm, std::string_view layer, const std::string& color);
  void write_base(const Point& base);
  void write_labels(const std::vector<FramedPrimitive>& primitives, LabelPlacer placer);

 private:
  void write_lines(const Arm& arm, const std::string& color, double width, double opacity);
  SvgWriter& svg_;
  const PlanarView& view_;
};

}  // namespace mneme::internal
