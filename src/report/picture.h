// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The parts of a planar picture, from the back to the front: the plane and its map to pixels,
/// outlines of obstacles, arms as lines, what is drawn of a plan, its words and its layers.
#pragma once

#include "mneme/geometry.h"
#include "mneme/planning.h"
#include "mneme/report.h"
#include "mneme/robot.h"
#include "mneme/sampling.h"

#include "report/markup.h"
#include "report/picture.h"

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace mneme::internal {

/// An axis-aligned rectangle that grows; metres.
struct Bounds {
  double left = std::numeric_limits<double>::infinity();
  double right = -std::numeric_limits<double>::infinity();
  double bottom = std::numeric_limits<double>::infinity();
  double top = -std::numeric_limits<double>::infinity();

  void include(const Point& point, double margin = 0);
  void include(std::span<const Point> points);
  /// The part of this that lies in `other`; empty if none does.
  [[nodiscard]] Bounds clipped(const Bounds& other) const;
  [[nodiscard]] bool is_empty() const { return left > right || bottom > top; }
  [[nodiscard]] double width() const { return right - left; }
  [[nodiscard]] double height() const { return top - bottom; }
};

/// Shows bounds, with a margin, in the middle of a panel of a given width; its height follows from
/// the aspect ratio, kept between a letterbox and a square or so.
class PlanarView {
 public:
  PlanarView(const Bounds& bounds, const Point& corner, double width);

  [[nodiscard]] Point pixel(const Point& metres) const;
  [[nodiscard]] std::vector<Point> pixels(std::span<const Point> metres) const;
  /// Pixels per metre.
  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] double height() const { return height_; }

 private:
  Point center_;  // of the bounds, metres
  Point middle_;  // of the panel, pixels
  double scale_ = 1;
  double height_ = 0;
};

struct Disc {
  Point center;
  double radius = 0;
};
using Polygon = std::vector<Point>;  ///< convex, counter-clockwise
using Outline = std::variant<Disc, Polygon>;

/// What a planar robot meets of `shape`, or nothing if the shape stays clear of its plane: the
/// section of a sphere, and the shadow of any other shape along z, which is its section if it
/// stands upright.
[[nodiscard]] std::optional<Outline> planar_outline(const Shape& shape);

[[nodiscard]] Bounds bounds_of(const Outline& outline);

/// The centre line of links that are joined end to end; metres.
struct ArmLine {
  std::vector<Point> points;
  double radius = 0;  ///< of the thickest link on it
};
using Arm = std::vector<ArmLine>;

/// The capsules of the robot's links at `q`, and its spheres as lines of one point.
[[nodiscard]] Arm arm_at(const Robot& robot, std::span<const double> q);

/// The configuration at `fraction` of a motion.
[[nodiscard]] Configuration along(const Robot& robot, std::span<const double> from,
                                  std::span<const double> to, double fraction);

/// `count` >= 2 configurations at equal distances along `path`, which is not empty; both ends
/// included.
[[nodiscard]] std::vector<Configuration> spread_along(const Robot& robot, const Path& path,
                                                      int count);

/// At most `limit` components, shared as evenly as can be among their sources and spread over each,
/// so that every primitive is seen. In ascending order.
[[nodiscard]] std::vector<int> choose_components(const GaussianMixture& mixture, int limit);

/// A primitive in the rectangle around its two circles.
struct FramedPrimitive {
  std::vector<Point> corners;  ///< counter-clockwise
  std::string label;  ///< how many matches there are, and the similarity error of the nearest
};

struct RememberedArm {
  SampleSource source = 0;  ///< index of the primitive
  Arm arm;
};

struct Drawing {
  std::vector<Outline> obstacles;
  std::vector<FramedPrimitive> primitives;
  std::vector<RememberedArm> memories;
  std::vector<Arm> fan;          ///< along the path, from start to goal, without both
  std::vector<Point> tip_trace;  ///< of the end of the last link along the path
  Arm start;
  std::vector<Arm> goals;
  Point base;
  double reach = 0;  ///< no point of the robot is farther from the base
};

/// Why start, goals, path or mixture do not fit the problem's robot; nothing if they do. `gl` may
/// be null.
[[nodiscard]] std::optional<std::string> find_misfit(const Problem& problem, const Path& path,
                                                     const GlSampler* gl);

/// Errors: unsupported if the robot is not planar; invalid if a configuration, a primitive or the
/// mixture does not fit it.
[[nodiscard]] Result<Drawing> make_drawing(const PlanarPicture& picture);

/// Bounds of all that is drawn, obstacles only as far as the arm reaches.
[[nodiscard]] Bounds bounds_of(const Drawing& drawing);

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

inline constexpr std::string_view kGoalColor = "#d9303a";
/// Colours repeat after ten primitives; kUniformSource is grey.
[[nodiscard]] std::string primitive_color(SampleSource source);

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
