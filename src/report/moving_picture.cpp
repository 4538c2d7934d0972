// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/report.h"

#include "base/as_index.h"
#include "base/fail.h"
#include "report/picture.h"
#include "report/trace.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace mneme::internal {
namespace {

constexpr double kWidth = 640;   // pixels
constexpr double kHeight = 480;  // pixels
constexpr double kBorder = 16;   // pixels
constexpr int kCorners = 16;     // of a circle
constexpr double kPauseShare = 0.12;

/// A convex outline in the picture plane, and its distance towards the viewer in metres.
struct Face {
  Polygon outline;
  double depth = 0;
  double light = 1;  ///< 0 dark to 1 bright
};

/// A parallel projection.
class Camera {
 public:
  Camera(double azimuth, double elevation) {
    towards_ = Vec3(std::cos(azimuth) * std::cos(elevation),
                    std::sin(azimuth) * std::cos(elevation), std::sin(elevation));
    right_ = Vec3(-std::sin(azimuth), std::cos(azimuth), 0);
    up_ = towards_.cross(right_);
  }
  [[nodiscard]] const Vec3& towards() const { return towards_; }  ///< from the scene to the viewer
  /// Metres in the picture plane, y downwards.
  [[nodiscard]] Point project(const Vec3& p) const { return {right_.dot(p), -up_.dot(p)}; }
  [[nodiscard]] double depth(const Vec3& p) const { return towards_.dot(p); }

 private:
  Vec3 towards_, right_, up_;
};

void append_disc(const Camera& camera, const Vec3& center, double radius, Polygon& points) {
  const Point middle = camera.project(center);
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2 * std::numbers::pi * i / kCorners;
    points.push_back({middle.x + radius * std::cos(angle), middle.y + radius * std::sin(angle)});
  }
}

Face make_face(const Camera& camera, std::span<const Vec3> corners, double light) {
  Face face{{}, 0, light};
  for (const Vec3& corner : corners) {
    face.outline.push_back(camera.project(corner));
    face.depth += camera.depth(corner) / static_cast<double>(corners.size());
  }
  face.outline = convex_hull(std::move(face.outline));
  return face;
}

/// The sides of a box that face the viewer.
void append_faces(const Camera& camera, const Box& box, std::vector<Face>& faces) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      const Vec3 normal = sign * box.pose.rotation.col(axis);
      if (normal.dot(camera.towards()) <= 0) continue;
      std::array<Vec3, 4> corners;
      for (int i = 0; i < 4; ++i) {
        Vec3 at = Vec3::Zero();
        at[axis] = sign;
        at[(axis + 1) % 3] = i % 2 * 2 - 1;
        at[(axis + 2) % 3] = i / 2 * 2 - 1;
        corners[as_index(i)] = box.pose * at.cwiseProduct(box.half_extents).eval();
      }
      faces.push_back(make_face(camera, corners, 0.5 + 0.5 * std::abs(normal.z())));
    }
  }
}

void append_faces(const Camera& camera, const Cylinder& cylinder, std::vector<Face>& faces) {
  std::vector<Vec3> points;
  for (int i = 0; i < 2 * kCorners; ++i) {
    const double angle = 2 * std::numbers::pi * i / kCorners;
    points.push_back(cylinder.pose * Vec3(cylinder.radius * std::cos(angle),
                                          cylinder.radius * std::sin(angle),
                                          (i < kCorners ? 0.5 : -0.5) * cylinder.length));
  }
  faces.push_back(make_face(camera, points, 0.7));
}

void append_faces(const Camera& camera, const Capsule& capsule, std::vector<Face>& faces) {
  Polygon points;
  append_disc(camera, capsule.a, capsule.radius, points);
  append_disc(camera, capsule.b, capsule.radius, points);
  faces.push_back({convex_hull(std::move(points)), camera.depth(capsule.a), 0.7});
}

void append_faces(const Camera& camera, const Sphere& sphere, std::vector<Face>& faces) {
  append_faces(camera, Capsule{sphere.center, sphere.center, sphere.radius}, faces);
}

/// Compound shapes are not shown.
template <class Part>
void append_faces(const Camera&, const CompoundShape<Part>&, std::vector<Face>&) {}

std::vector<Face> scene_faces(const Camera& camera, const Scene& scene) {
  std::vector<Face> faces;
  for (const Obstacle& obstacle : scene.obstacles) {
    for (const Shape& shape : obstacle.shapes) {
      std::visit([&](const auto& it) { append_faces(camera, it, faces); }, shape);
    }
  }
  std::ranges::sort(faces, {}, &Face::depth);
  return faces;
}

/// The hulls of the robot's links at `q`, from back to front.
std::vector<Face> robot_faces(const Camera& camera, const Robot& robot, std::span<const double> q) {
  const std::vector<Transform> poses = robot.link_poses(q);
  std::vector<Face> faces;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    Polygon points;
    double depth = 0;
    const Link& link = robot.links()[i];
    for (const Sphere& sphere : link.spheres) {
      append_disc(camera, poses[i] * sphere.center, sphere.radius, points);
      depth += camera.depth(poses[i] * sphere.center);
    }
    for (const Capsule& capsule : link.capsules) {
      append_disc(camera, poses[i] * capsule.a, capsule.radius, points);
      append_disc(camera, poses[i] * capsule.b, capsule.radius, points);
      depth += camera.depth(poses[i] * (capsule.a + capsule.b) / 2);
    }
    const auto parts = static_cast<double>(link.spheres.size() + link.capsules.size());
    if (!points.empty()) faces.push_back({convex_hull(std::move(points)), depth / parts, 1});
  }
  std::ranges::sort(faces, {}, &Face::depth);
  return faces;
}

/// Maps the picture plane to pixels.
class Frame {
 public:
  explicit Frame(const Bounds& bounds)
      : scale_(std::min((kWidth - 2 * kBorder) / bounds.width(),
                        (kHeight - 2 * kBorder) / bounds.height())),
        left_(kWidth / 2 - scale_ * (bounds.left + bounds.right) / 2),
        top_(kHeight / 2 - scale_ * (bounds.bottom + bounds.top) / 2) {}
  [[nodiscard]] std::string points(std::span<const Point> outline) const {
    Polygon pixels;
    for (const Point& p : outline) pixels.push_back({left_ + scale_ * p.x, top_ + scale_ * p.y});
    return short_points(pixels, 1);
  }

 private:
  double scale_, left_, top_;
};

std::string grey(double light) {
  const int level = 150 + static_cast<int>(90 * light);
  return fmt::format("#{0:02x}{0:02x}{1:02x}", level, std::min(255, level + 8));
}

/// Shows an element in frame `index` of `count`; the first and the last frame last longer.
void write_turn(SvgWriter& svg, std::size_t index, std::size_t count, double seconds) {
  const auto begin_of = [&](std::size_t i) {
    if (i == 0) return 0.0;
    if (i >= count) return 1.0;
    const double share = static_cast<double>(i - 1) / static_cast<double>(count - 2);
    return kPauseShare + (1 - 2 * kPauseShare) * share;
  };
  std::string times = "0", values = index == 0 ? "inline" : "none";
  if (index > 0) times += fmt::format(";{:.4f}", begin_of(index)), values += ";inline";
  if (index + 1 < count) times += fmt::format(";{:.4f}", begin_of(index + 1)), values += ";none";
  svg.element("animate", {{"attributeName", "display"},
                          {"dur", fmt::format("{:g}s", seconds)},
                          {"repeatCount", "indefinite"},
                          {"calcMode", "discrete"},
                          {"keyTimes", times},
                          {"values", values}});
}

void write_faces(SvgWriter& svg, const Frame& frame, const std::vector<Face>& faces) {
  for (const Face& face : faces) {
    svg.element("polygon", {{"points", frame.points(face.outline)}, {"fill", grey(face.light)}});
  }
}

void write_robot(SvgWriter& svg, const Frame& frame, const std::vector<std::vector<Face>>& states,
                 double seconds) {
  for (std::size_t i = 0; i < states.size(); ++i) {
    const double fraction = static_cast<double>(i) / static_cast<double>(states.size() - 1);
    svg.open("g", {{"fill", path_color(fraction)}, {"display", i == 0 ? "inline" : "none"}});
    write_turn(svg, i, states.size(), seconds);
    for (const Face& face : states[i]) {
      svg.element("polygon", {{"points", frame.points(face.outline)}});
    }
    svg.close();
  }
}

}  // namespace
}  // namespace mneme::internal

namespace mneme {

using namespace internal;  // NOLINT(google-build-using-namespace)

Result<std::string> to_svg(const MovingPicture& picture) {
  const Problem& problem = *picture.problem;
  if (picture.path.size() < 2 || picture.frames < 3) {
    return fail(ErrorCode::invalid, "a moving picture needs a path and three frames or more");
  }
  const Camera camera(picture.azimuth, picture.elevation);
  const std::vector<Face> obstacles = scene_faces(camera, problem.scene);
  const Skeleton skeleton(problem.robot);
  std::vector<std::vector<Face>> states;
  std::vector<Point> tips;
  Bounds bounds;
  for (const Configuration& q : spread_along(problem.robot, picture.path, picture.frames)) {
    states.push_back(robot_faces(camera, problem.robot, q));
    tips.push_back(camera.project(skeleton.points(q).back()));
    for (const Face& face : states.back()) bounds.include(face.outline);
  }
  for (const Face& face : obstacles) bounds.include(face.outline);
  const Frame frame(bounds);
  SvgWriter svg;
  svg.open("svg", {{"xmlns", "http://www.w3.org/2000/svg"},
                   {"viewBox", fmt::format("0 0 {} {}", kWidth, kHeight)},
                   {"width", short_number(kWidth)},
                   {"height", short_number(kHeight)}});
  svg.text_element("title", {}, fmt::format("{}: {}", problem.robot.name(), problem.name));
  svg.element("rect", {{"width", "100%"}, {"height", "100%"}, {"fill", "#ffffff"}});
  svg.open("g", {{"stroke", "#8a8f98"}, {"stroke-width", "0.6"}, {"stroke-linejoin", "round"}});
  write_faces(svg, frame, obstacles);
  svg.close();
  svg.open("g", {{"stroke", "#ffffff"}, {"stroke-width", "0.7"}, {"stroke-linejoin", "round"}});
  write_robot(svg, frame, states, picture.seconds);
  svg.close();
  svg.open("g", {{"opacity", "0.35"}, {"stroke", "#8a8f98"}, {"stroke-width", "0.6"}});
  write_faces(svg, frame, obstacles);
  svg.close();
  svg.element("polyline", {{"points", frame.points(tips)},
                           {"fill", "none"},
                           {"stroke", "#1b1f24"},
                           {"stroke-width", "1.2"},
                           {"stroke-dasharray", "4 3"}});
  svg.close();
  return svg.str();
}

}  // namespace mneme
