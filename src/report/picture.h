// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The parts of a planar picture: the map from metres to pixels, outlines of obstacles, arms as
/// lines, labels and the layers from back to front.
#pragma once

#include "mneme/geometry.h"
#include "mneme/planning.h"
#include "mneme/report.h"
#include "mneme/robot.h"
#include "mneme/sampling.h"

#include "report/markup.h"

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace mneme::internal {

/// An axis-aligned bounding rectangle in metres.
struct Bounds {
  double left = std::numeric_limits<double>::infinity();
  double right = -std::numeric_limits<double>::infinity();
  double bottom = std::numeric_limits<double>::infinity();
  double top = -std::numeric_limits<double>::infinity();

  void include(const Point& point, double margin = 0);
  void include(std::span<const Point> points);
  /// Returns the intersection with `other`.
  [[nodiscard]] Bounds clipped(const Bounds& other) const;
  [[nodiscard]] bool is_empty() const { return left > right || bottom > top; }
  [[nodiscard]] double width() const { return right - left; }
  [[nodiscard]] double height() const { return top - bottom; }
};

/// Maps bounds, with a margin, to the middle of a panel of `width` pixels. The panel's height
/// follows from the aspect ratio within limits.
class PlanarView {
 public:
  PlanarView(const Bounds& bounds, const Point& corner, double width);

  [[nodiscard]] Point pixel(const Point& metres) const;
  [[nodiscard]] std::vector<Point> pixels(std::span<const Point> metres) const;
  [[nodiscard]] double scale() const { return scale_; }  ///< pixels per metre
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

/// Returns the convex hull of `points`.
[[nodiscard]] Polygon convex_hull(Polygon points);

/// Returns the outline of `shape` in the plane z = 0: the section of a sphere, the projection along
/// z of other shapes. Empty if the shape does not meet the plane.
[[nodiscard]] std::optional<Outline> planar_outline(const Shape& shape);

[[nodiscard]] Bounds bounds_of(const Outline& outline);

/// The centre line of links that are joined end to end, in metres.
struct ArmLine {
  std::vector<Point> points;
  double radius = 0;  ///< largest radius of these links
};
using Arm = std::vector<ArmLine>;

/// Returns the capsules of the robot's links at `q`, and its spheres as lines of one point.
[[nodiscard]] Arm arm_at(const Robot& robot, std::span<const double> q);

/// Returns `count` >= 2 configurations at equal distances along a path that is not empty, with both
/// ends.
[[nodiscard]] std::vector<Configuration> spread_along(const Robot& robot, const Path& path,
                                                      int count);

/// Returns the indices of at most `limit` components in ascending order. Each source gets an equal
/// share, spread over its components, so that every primitive is shown.
[[nodiscard]] std::vector<int> choose_components(const GaussianMixture& mixture, int limit);

/// A primitive as the rectangle around its two circles.
struct FramedPrimitive {
  std::vector<Point> corners;  ///< counter-clockwise
  std::string label;           ///< number of matches and the smallest similarity error
};

struct RememberedArm {
  SampleSource source = 0;  ///< index of the primitive
  Arm arm;
};

struct Drawing {
  std::vector<Outline> obstacles;
  std::vector<FramedPrimitive> primitives;
  std::vector<RememberedArm> memories;
  std::vector<Arm> fan;          ///< arms along the path without start and goal
  std::vector<Point> tip_trace;  ///< end-effector path
  Arm start;
  std::vector<Arm> goals;
  Point base;
  double reach = 0;  ///< upper bound of the distance from the base to any point of the robot
};

/// Says why start, goals, path or mixture do not fit the problem's robot; empty if they do. `gl`
/// may be null.
[[nodiscard]] std::optional<std::string> find_misfit(const Problem& problem, const Path& path,
                                                     const GlSampler* gl);

/// Errors: as to_svg().
[[nodiscard]] Result<Drawing> make_drawing(const PlanarPicture& picture);

/// Returns the bounds of a drawing, with obstacles clipped to the reach of the arm.
[[nodiscard]] Bounds bounds_of(const Drawing& drawing);

inline constexpr std::string_view kFontFamily =
    "Inter, 'Helvetica Neue', Helvetica, Arial, 'DejaVu Sans', sans-serif";

/// Estimates the width of `text` in pixels; fonts differ between viewers.
[[nodiscard]] double text_width(std::string_view text, double font_size);

/// An axis-aligned rectangle in pixels.
struct PixelBox {
  double left = 0, top = 0, right = 0, bottom = 0;
};
[[nodiscard]] double overlap_area(const PixelBox& a, const PixelBox& b);

/// Places labels one after the other.
class LabelPlacer {
 public:
  explicit LabelPlacer(const PixelBox& panel) : panel_(panel) {}
  /// Keeps later labels off `box` if possible.
  void avoid(const PixelBox& box) { taken_.push_back(box); }
  /// Keeps later labels off a line if possible.
  void avoid_line(std::span<const Point> points);
  /// Places a label at the candidate centre that overlaps least with taken areas and the outside of
  /// the panel. `candidates`: not empty, best first.
  Point place(std::span<const Point> candidates, double width, double height);

 private:
  PixelBox panel_;
  std::vector<PixelBox> taken_;
  std::vector<PixelBox> labels_;
};

/// Returns candidate centres for a label around a convex polygon of either orientation.
[[nodiscard]] std::vector<Point> label_places(std::span<const Point> corners, double width,
                                              double height);

enum class LegendMark { bold_line, fan, dashed_box, thin_lines };

struct LegendEntry {
  LegendMark mark = LegendMark::bold_line;
  std::string color;  ///< empty for the fan
  std::string words;
};
/// Returns the colour at `fraction` of a path: blue at the start, red at the goal.
[[nodiscard]] std::string path_color(double fraction);

/// Returns the height of the legend in pixels when its entries flow in rows of `width`.
[[nodiscard]] double legend_height(std::span<const LegendEntry> entries, double width);
void write_legend(SvgWriter& svg, std::span<const LegendEntry> entries, const Point& corner,
                  double width);

inline constexpr std::string_view kGoalColor = "#d9303a";
/// Returns the colour of a primitive. Colours repeat after ten; kUniformSource is grey.
[[nodiscard]] std::string primitive_color(SampleSource source);

/// Writes the layers of a picture from back to front.
class PictureWriter {
 public:
  PictureWriter(SvgWriter& svg, const PlanarView& view) : svg_(svg), view_(view) {}

  void write_obstacles(const std::vector<Outline>& obstacles);
  /// Writes the frames in a group with these attributes. `paint` is fill or stroke, in the colours
  /// of the primitives.
  void write_frames(const std::vector<FramedPrimitive>& primitives, std::string_view paint,
                    Attributes group);
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
