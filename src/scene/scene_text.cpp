// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/fail.h"
#include "base/text.h"
#include "geometry/tolerated.h"
#include "input/elided.h"
#include "scene/moveit_scene.h"
#include "scene/scene_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mneme::internal {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";

/// Reads objects of MoveIt's scene text one after the other.
class SceneText {
 public:
  SceneText(std::string_view text, const std::string& source) : rest_(text), source_(source) {}

  Scene read(const std::string& default_name) {
    const std::string_view name = next_line();
    has_poses_ = has_poses();
    for (std::string_view marker = next_word(); marker != "."; marker = next_word()) {
      if (marker != "*") {
        fail(ErrorCode::parse, "expected \"* NAME\" of an object or a dot at the end, got \"{}\"",
             marker);
      }
      read_object();
    }
    Scene scene = scene_.take(name.empty() ? default_name : std::string(name)).scene;
    findings_.append_to(scene.warnings);
    return scene;
  }

 private:
  std::string_view next_line() {
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    const std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    ++line_;
    return trimmed(line);
  }

  std::string_view next_word() {
    const std::size_t begin = std::min(rest_.find_first_not_of(kBlanks), rest_.size());
    line_ +=
        static_cast<int>(std::count(rest_.begin(), rest_.begin() + static_cast<long>(begin), '\n'));
    rest_.remove_prefix(begin);
    const std::string_view word = rest_.substr(0, rest_.find_first_of(kBlanks));
    if (word.empty())
      fail(ErrorCode::parse, "the scene ends early; expected a line with a dot last");
    rest_.remove_prefix(word.size());
    return word;
  }

  double read_number() {
    const std::string_view word = next_word();
    const auto value = parse_yaml_number(word);
    if (!value || !std::isfinite(*value)) {
      fail(ErrorCode::parse, "expected a finite number, got \"{}\"", word);
    }
    return *value;
  }

  double read_size() {
    const double value = read_number();
    if (value < 0) fail(ErrorCode::parse, "expected a size above 0, got {}", value);
    if (value == 0) warn(kThinFault);
    return thickened(value);
  }

  std::size_t read_count(std::size_t most) {
    const std::string_view word = next_word();
    const auto value = parse_number<std::size_t>(word);
    if (!value || *value > most) {
      fail(ErrorCode::parse, "expected a whole number up to {}, got \"{}\"", most, word);
    }
    return *value;
  }

  Vec3 read_vector() {
    const double x = read_number(), y = read_number(), z = read_number();
    return {x, y, z};
  }

  Transform read_pose() {
    const Vec3 position = read_vector();
    const Vec3 xyz = read_vector();
    const double w = read_number();
    if (xyz.isZero(0) && w == 0) return {Eigen::Matrix3d::Identity(), position};  // unset
    const QuaternionLength length = judge_length({xyz.x(), xyz.y(), xyz.z(), w});
    if (length == QuaternionLength::wrong) {
      fail(ErrorCode::parse, "expected a quaternion of length 1, got {} {} {} {}", xyz.x(), xyz.y(),
           xyz.z(), w);
    }
    if (length == QuaternionLength::tolerated) warn(kScaledFault);
    return {rotation_from_quaternion(w, xyz.x(), xyz.y(), xyz.z()), position};
  }

  Mesh read_mesh() {
    constexpr std::size_t kMost = 10'000'000;
    const std::size_t vertex_count = read_count(kMost), triangle_count = read_count(kMost);
    std::vector<Vec3> vertices;
    while (vertices.size() < vertex_count) vertices.push_back(read_vector());
    std::vector<Triangle> triangles;
    for (std::size_t i = 0; i < triangle_count; ++i) {
      std::array<Vec3, 3> corners;
      for (Vec3& corner : corners) {
        const std::size_t index = read_count(kMost);
        if (index >= vertex_count) fail(ErrorCode::parse, "there is no vertex {}", index);
        corner = vertices[index];
      }
      triangles.push_back({corners[0], corners[1], corners[2]});
      if (triangles.back().area() <= 0) triangles.pop_back();
    }
    if (triangles.empty())
      fail(ErrorCode::parse, "expected a mesh with a triangle that has an area");
    return {{}, std::make_shared<Parts<Triangle>>(std::move(triangles)), 0};
  }

  /// The sizes of a shape, then its pose in the object's frame.
  Shape read_shape(const std::string& object, const Transform& X_RO) {
    const std::string_view type = next_word();
    Shape shape;
    std::optional<std::array<double, 4>> plane;
    if (type == "sphere") {
      shape = Sphere{Vec3::Zero(), read_size()};
    } else if (type == "box") {
      const double x = read_size(), y = read_size(), z = read_size();
      shape = Box{{}, 0.5 * Vec3(x, y, z)};
    } else if (type == "cylinder" || type == "cone") {
      if (type == "cone") warn(kConeFault);
      const double radius = read_size();
      shape = Cylinder{{}, radius, read_size()};
    } else if (type == "mesh") {
      shape = read_mesh();
    } else if (type == "plane") {
      plane.emplace();
      for (double& coefficient : *plane) coefficient = read_number();
    } else {
      fail(
          ErrorCode::unsupported,
          "object \"{}\" has the shape \"{}\"; expected sphere, box, cylinder, cone, mesh or plane",
          object, type);
    }
    const Transform X_RS = X_RO * read_pose();
    if (!plane) return transformed(X_RS, shape);
    const auto box = box_of_plane(*plane, X_RS);
    if (!box) fail(ErrorCode::parse, "expected a plane with a normal that is not zero");
    return centred_plane(*box);
  }

  void skip_subframes() {
    constexpr std::size_t kMost = 100'000;
    for (std::size_t left = read_count(kMost); left > 0; --left) {
      static_cast<void>(next_word());
      static_cast<void>(read_pose());
    }
  }

  void read_object() {
    constexpr std::size_t kMost = 4'000'000;
    const std::string name(next_line());
    const int line = line_ - 1;
    const Transform X_RO = has_poses_ ? read_pose() : Transform{};
    for (std::size_t left = read_count(kMost); left > 0; --left) {
      const Shape shape = read_shape(name, X_RO);
      for (int i = 0; i < 4; ++i) static_cast<void>(read_number());  // its colour
      if (const auto wrong = scene_.add("", name, shape)) {
        throw_failure(ErrorCode::parse, "{}:{}: {}", source_, line, elided(*wrong));
      }
    }
    if (has_poses_) skip_subframes();
  }

  /// Objects have a pose and subframes since MoveIt 1.1.
  [[nodiscard]] bool has_poses() const {
    SceneText ahead = *this;
    while (!ahead.rest_.empty() && !ahead.next_line().starts_with('*')) {
    }
    return ahead.next_line().find(' ') != std::string_view::npos;
  }

  void warn(std::string_view what) {
    findings_.add(std::string(what), fmt::format("{}:{}: {}", source_, line_, what));
  }

  template <class... Args>
  [[noreturn]] void fail(ErrorCode code, fmt::format_string<Args...> what, Args&&... args) const {
    throw_failure(code, "{}:{}: {}", source_, line_,
                  elided(fmt::format(what, std::forward<Args>(args)...)));
  }

  std::string_view rest_;
  const std::string& source_;
  int line_ = 1;
  bool has_poses_ = false;
  SceneBuilder scene_;
  InputFindings findings_;
};

}  // namespace

bool is_scene_text(std::string_view text) {
  text.remove_prefix(std::min(text.find('\n'), text.size()));
  const std::string_view rest = text.substr(std::min(text.find_first_not_of(kBlanks), text.size()));
  return rest.starts_with("* ") || trimmed(rest) == ".";
}

Scene read_scene_text(std::string_view text, const std::string& source,
                      const std::string& default_name) {
  return SceneText(text, source).read(default_name);
}

}  // namespace mneme::internal
