// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/shape_fields.h"

#include "scene/compound_fields.h"
#include "scene/yaml.h"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mneme::internal {
namespace {

/// Reads the shape of one obstacle, and refuses keys that its type does not have.
class ShapeReader {
 public:
  ShapeReader(const Input& input, const ObstacleSpelling& spelling,
              std::vector<std::string>& warnings)
      : input_(input), spelling_(spelling), warnings_(warnings) {}

  Shape read() const {
    refuse_file(input_, spelling_);
    const Input type = input_.at("type");
    return read_one_of(type, type.is_text() ? type.text() : "");
  }

 private:
  template <std::size_t kIndex = 0>
  Shape read_one_of(const Input& type, const std::string& name) const {
    if constexpr (kIndex == std::variant_size_v<Shape>) {
      const std::string kinds = "sphere, box, cylinder, capsule, points, mesh or octree";
      const bool is_flat = name == "circle" || name == "disc" || name == "disk";
      type.fail_expecting(is_flat ? kinds +
                                        "; circles of a planar scene stand under its key "
                                        "circles, as name: [x, y, radius]"
                                  : kinds);
    } else {
      const std::variant_alternative_t<kIndex, Shape> shape;
      return name == shape_name(shape) ? read(shape) : read_one_of<kIndex + 1>(type, name);
    }
  }

  void allow(std::vector<std::string_view> keys) const {
    keys.insert(keys.begin(), "type");
    keys.insert(keys.begin(), spelling_.naming.begin(), spelling_.naming.end());
    input_.allow_keys(keys);
  }
  void allow_posed(std::initializer_list<std::string_view> sizes) const {
    std::vector<std::string_view> keys = {spelling_.position, spelling_.quaternion};
    keys.insert(keys.end(), sizes);
    allow(std::move(keys));
  }

  Transform read_pose() const {
    Transform pose;
    pose.translation = read_point(input_.at(spelling_.position));
    if (const auto quaternion = input_.find(spelling_.quaternion)) {
      pose.rotation = read_rotation(*quaternion, spelling_.is_scalar_first);
    }
    return pose;
  }

  /// The shape stands where its file says, unless it has a pose.
  template <class Part>
  Shape with_pose(CompoundShape<Part> compound, bool has_radius) const {
    if (input_.find(spelling_.position) || input_.find(spelling_.quaternion)) {
      compound.pose = read_pose();
    }
    if (has_radius) compound.radius = read_size("radius");
    return compound;
  }

  double read_size(std::string_view key) const { return input_.at(key).positive_number(); }

  Shape read(const Sphere&) const {
    allow_posed({"radius"});
    return Sphere{read_pose().translation, read_size("radius")};
  }

  Shape read(const Box&) const {
    allow_posed({"size"});
    const Input size = input_.at("size");
    const std::vector<double> extents = size.finite_numbers(3, "full extents in metres");
    for (const Input& extent : size.items()) static_cast<void>(extent.positive_number());
    return Box{read_pose(), 0.5 * Vec3(extents[0], extents[1], extents[2])};
  }

  Shape read(const Cylinder&) const {
    allow_posed({"radius", "length"});
    return Cylinder{read_pose(), read_size("radius"), read_size("length")};
  }

  Shape read(const Capsule&) const {
    if (input_.find("a") || input_.find("b")) {
      allow({"a", "b", "radius"});
      return Capsule{read_point(input_.at("a")), read_point(input_.at("b")), read_size("radius")};
    }
    allow_posed({"radius", "length"});
    const Transform pose = read_pose();
    const Vec3 to_end = 0.5 * read_size("length") * Vec3::UnitZ();
    return Capsule{pose * Vec3(-to_end), pose * to_end, read_size("radius")};
  }

  Shape read(const PointCloud&) const {
    allow_posed({"radius", "file", "scale", "points"});
    return with_pose(read_points(input_, warnings_), true);
  }

  Shape read(const Mesh&) const {
    allow_posed({"radius", "file", "scale", "triangles"});
    return with_pose(read_mesh_shape(input_, warnings_), input_.find("radius").has_value());
  }

  Shape read(const Octree&) const {
    allow_posed({"radius", "file", "unknown", "cubes"});
    return with_pose(read_octree_shape(input_), input_.find("radius").has_value());
  }

  const Input& input_;
  const ObstacleSpelling& spelling_;
  std::vector<std::string>& warnings_;
};

class DescribeFields {
 public:
  using Fields = std::vector<ShapeField>;
  explicit DescribeFields(const ObstacleSpelling& spelling) : spelling_(spelling) {}

  Fields operator()(const Sphere& s) const {
    return {point(spelling_.position, s.center), {"radius", {s.radius}}};
  }
  Fields operator()(const Box& s) const {
    return posed(s.pose, {point("size", 2.0 * s.half_extents)});
  }
  Fields operator()(const Cylinder& s) const {
    return posed(s.pose, {{"radius", {s.radius}}, {"length", {s.length}}});
  }
  Fields operator()(const Capsule& s) const {
    return {point("a", s.a), point("b", s.b), {"radius", {s.radius}}};
  }
  template <class Part>
  Fields operator()(const CompoundShape<Part>& s) const {
    Fields own;
    if (s.radius > 0) own.push_back({"radius", {s.radius}});
    own.push_back({key_of(*s.parts), numbers_of(*s.parts), true});
    return posed(s.pose, own);
  }

 private:
  static std::string_view key_of(const Parts<CloudPoint>&) { return "points"; }
  static std::string_view key_of(const Parts<Triangle>&) { return "triangles"; }
  static std::string_view key_of(const Parts<Cube>&) { return "cubes"; }

  static ShapeField point(std::string_view key, const Vec3& p) {
    return {key, {p.x(), p.y(), p.z()}, true};
  }

  [[nodiscard]] Fields posed(const Transform& pose, const Fields& sizes) const {
    Fields fields = {point(spelling_.position, pose.translation)};
    if (spelling_.writes_no_rotation || pose.rotation != Eigen::Matrix3d::Identity()) {
      const Eigen::Quaterniond q(pose.rotation);
      fields.push_back({spelling_.quaternion, {q.x(), q.y(), q.z(), q.w()}, true});
      std::vector<double>& values = fields.back().values;
      if (spelling_.is_scalar_first) std::rotate(values.begin(), values.end() - 1, values.end());
    }
    fields.insert(fields.end(), sizes.begin(), sizes.end());
    return fields;
  }

  const ObstacleSpelling& spelling_;
};

}  // namespace

void refuse_file(const Input& input, const ObstacleSpelling& spelling) {
  const auto file = spelling.may_name_files ? std::nullopt : input.find("file");
  if (!file) return;
  file->fail(ErrorCode::invalid,
             "expected numbers, as points, triangles or cubes: no files are read for a request");
}

Vec3 read_point(const Input& input) {
  const std::vector<double> p = input.finite_numbers(3, "x, y, z in metres");
  return {p[0], p[1], p[2]};
}

Eigen::Matrix3d read_rotation(const Input& input, bool is_scalar_first) {
  const std::vector<double> q = input.finite_numbers(
      4, is_scalar_first ? "a quaternion w, x, y, z" : "a quaternion x, y, z, w");
  return is_scalar_first ? rotation_of(input, {q[1], q[2], q[3], q[0]})
                         : rotation_of(input, {q[0], q[1], q[2], q[3]});
}

Eigen::Matrix3d rotation_of(const Input& input, const std::array<double, 4>& xyzw) {
  constexpr double kLeastNorm = 1e-6;
  const auto [x, y, z, w] = xyzw;
  if (std::hypot(std::hypot(x, y), std::hypot(z, w)) < kLeastNorm) {
    input.fail(ErrorCode::parse, "expected a quaternion that is not zero");
  }
  return rotation_from_quaternion(w, x, y, z);
}

Shape read_shape(const Input& input, const ObstacleSpelling& spelling,
                 std::vector<std::string>& warnings) {
  return ShapeReader(input, spelling, warnings).read();
}

std::vector<ShapeField> shape_fields(const Shape& shape, const ObstacleSpelling& spelling) {
  return std::visit(DescribeFields(spelling), shape);
}

std::string yaml_shape(const Shape& shape) {
  std::string text = fmt::format("type: {}", shape_name(shape));
  for (const ShapeField& field : shape_fields(shape, kSceneSpelling)) {
    text += fmt::format(", {}: {}", field.key,
                        field.is_list ? yaml_numbers(field.values) : yaml_number(field.values[0]));
  }
  return text;
}

}  // namespace mneme::internal
