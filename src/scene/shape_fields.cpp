// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/axis_box.h"
#include "geometry/tolerated.h"
#include "mesh/mesh_file.h"
#include "scene/compound_files.h"
#include "scene/scene_input.h"

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

namespace mneme::internal {
namespace {

/// Metres. Longer objects are probably given in another unit.
constexpr double kLongestLikely = 50;

/// The key `file`, which replaces the list `key`.
std::optional<Input> find_file(const Input& input, std::string_view key) {
  auto file = input.find("file");
  if (file && input.find(key)) {
    file->fail(ErrorCode::parse, "expected either file or {}, got both", key);
  }
  return file;
}

/// The path of the key `file`, relative to the file that names it.
std::string path_of(const Input& file) {
  if (!file.is_text() || file.text().empty()) file.fail_expecting("the path of a file");
  return (std::filesystem::path(file.source()).parent_path() / file.text()).string();
}

double scale_of(const Input& input) {
  const auto scale = input.find("scale");
  return scale ? scale->positive_number() : 1.0;
}

template <class Part>
void warn_of_unit(const Input& file, const std::vector<Part>& parts) {
  const AxisBox box = box_around(parts);
  const double longest = (box.high - box.low).maxCoeff();
  if (!(longest > kLongestLikely)) return;
  file.warn(fmt::format("is {:.0f} m long; one in millimetres needs scale: 0.001", longest));
}

/// Numbers of the list `key`, `count` for each part: all in one list, or a list for each part.
std::vector<double> list_of(const Input& input, std::string_view key, std::size_t count) {
  const Input list = input.at(key);
  std::vector<double> numbers;
  if (list.has_rows()) {
    for (const Input& row : list.items()) {
      const std::vector<double> part = row.finite_numbers(count, "numbers of one part");
      numbers.insert(numbers.end(), part.begin(), part.end());
    }
  } else {
    numbers = list.numbers();
  }
  if (numbers.empty() || numbers.size() % count != 0) {
    list.fail(ErrorCode::parse, "expected {} numbers for each of the parts, got {}", count,
              numbers.size());
  }
  for (const double x : numbers) {
    if (!std::isfinite(static_cast<float>(x))) list.fail_expecting("finite numbers");
  }
  return numbers;
}

template <class Part>
CompoundShape<Part> compound_of(std::vector<Part> parts) {
  return {{}, std::make_shared<Parts<Part>>(std::move(parts)), 0};
}

PointCloud read_points(const Input& input) {
  std::vector<CloudPoint> points;
  const auto file = find_file(input, "points");
  const double scale = scale_of(input);
  const auto at = [&](double x, double y, double z) {
    points.push_back({static_cast<float>(scale * x), static_cast<float>(scale * y),
                      static_cast<float>(scale * z)});
  };
  if (!file) {
    const Input list = input.at("points");
    if (list.is_list() && list.size() == 0) {
      list.warn("there are no points, and the cloud is left out");
      return compound_of(std::move(points));
    }
    const std::vector<double> numbers = list_of(input, "points", 3);
    for (std::size_t i = 0; i < numbers.size(); i += 3) {
      at(numbers[i], numbers[i + 1], numbers[i + 2]);
    }
    return compound_of(std::move(points));
  }
  const std::string path = path_of(*file);
  const CloudFile cloud = file->take(read_cloud(path));
  if (!cloud.notes.empty()) {
    file->warn(fmt::format("{}: {}", path, fmt::join(cloud.notes, ", ")));
  }
  if (cloud.points.empty()) {
    file->warn(fmt::format("{}: no point of {} has finite coordinates, and the cloud is left out",
                           path, cloud.size()));
    return compound_of(std::move(points));
  }
  if (cloud.skipped > 0) {
    file->warn(fmt::format("{}: {} of {} points are not finite and ignored", path, cloud.skipped,
                           cloud.size()));
  }
  points.reserve(cloud.points.size());
  for (const CloudPoint& p : cloud.points) at(p[0], p[1], p[2]);
  warn_of_unit(*file, points);
  return compound_of(std::move(points));
}

Mesh read_mesh_shape(const Input& input) {
  if (const auto file = find_file(input, "triangles")) {
    const Vec3 scale = Vec3::Constant(scale_of(input));
    auto triangles = file->take(read_triangles(path_of(*file), scale, {}));
    warn_of_unit(*file, triangles);
    return compound_of(std::move(triangles));
  }
  const double scale = scale_of(input);
  const std::vector<double> n = list_of(input, "triangles", 9);
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < n.size(); i += 9) {
    triangles.push_back({scale * Vec3(n[i], n[i + 1], n[i + 2]),
                         scale * Vec3(n[i + 3], n[i + 4], n[i + 5]),
                         scale * Vec3(n[i + 6], n[i + 7], n[i + 8])});
  }
  return compound_of(std::move(triangles));
}

Octree read_octree_shape(const Input& input) {
  const auto file = find_file(input, "cubes");
  const auto unknown = input.find("unknown");
  const bool is_occupied = unknown && unknown->is_text() && unknown->text() == "occupied";
  if (unknown && !is_occupied && !(unknown->is_text() && unknown->text() == "free")) {
    unknown->fail_expecting("free or occupied");
  }
  if (file) {
    const std::string path = path_of(*file);
    auto read = file->take(read_octree(path, {is_occupied}));
    if (read.empty()) {
      file->warn(fmt::format("{}: no leaf is occupied, and the octree is left out", path));
    }
    return compound_of(std::move(read));
  }
  if (unknown) unknown->fail(ErrorCode::parse, "expected the key file with it, got cubes");
  const Input list = input.at("cubes");
  const std::vector<double> n = list_of(input, "cubes", 4);
  std::vector<Cube> cubes;
  for (std::size_t i = 0; i < n.size(); i += 4) {
    if (!(n[i + 3] > 0)) list.fail_expecting("edges above 0");
    cubes.push_back({Vec3(n[i], n[i + 1], n[i + 2]), 0.5 * n[i + 3]});
  }
  return compound_of(std::move(cubes));
}

void append(const Vec3& p, std::vector<double>& numbers) {
  numbers.insert(numbers.end(), {p.x(), p.y(), p.z()});
}

std::vector<double> numbers_of(const Parts<CloudPoint>& parts) {
  std::vector<double> numbers;
  for (const CloudPoint& p : parts.list()) numbers.insert(numbers.end(), {p[0], p[1], p[2]});
  return numbers;
}

std::vector<double> numbers_of(const Parts<Triangle>& parts) {
  std::vector<double> numbers;
  for (const Triangle& t : parts.list()) {
    for (const Vec3& p : {t.a, t.b, t.c}) append(p, numbers);
  }
  return numbers;
}

std::vector<double> numbers_of(const Parts<Cube>& parts) {
  std::vector<double> numbers;
  for (const Cube& c : parts.list()) {
    append(c.center, numbers);
    numbers.push_back(2 * c.half_extent);
  }
  return numbers;
}

/// Reads the shape of one obstacle, and refuses keys that its type does not have.
class ShapeReader {
 public:
  ShapeReader(const Input& input, const ObstacleSpelling& spelling)
      : input_(input), spelling_(spelling) {}

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
                                        "; a planar scene lists circles under the key "
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

  /// Without a pose, the coordinates of the file count.
  template <class Part>
  Shape with_pose(CompoundShape<Part> compound, bool has_radius) const {
    if (input_.find(spelling_.position) || input_.find(spelling_.quaternion)) {
      compound.pose = read_pose();
    }
    if (has_radius) compound.radius = read_size("radius");
    return compound;
  }

  double read_size(std::string_view key) const { return internal::read_size(input_.at(key)); }

  Shape read(const Sphere&) const {
    allow_posed({"radius"});
    return Sphere{read_pose().translation, read_size("radius")};
  }

  Shape read(const Box&) const {
    allow_posed({"size"});
    const Input size = input_.at("size");
    std::vector<double> extents = size.finite_numbers(3, "full extents in metres");
    if (std::ranges::min(extents) <= 0)
      std::ranges::transform(size.items(), extents.begin(), internal::read_size);
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
    return with_pose(read_points(input_), true);
  }

  Shape read(const Mesh&) const {
    allow_posed({"radius", "file", "scale", "triangles"});
    return with_pose(read_mesh_shape(input_), input_.find("radius").has_value());
  }

  Shape read(const Octree&) const {
    allow_posed({"radius", "file", "unknown", "cubes"});
    return with_pose(read_octree_shape(input_), input_.find("radius").has_value());
  }

  const Input& input_;
  const ObstacleSpelling& spelling_;
};

using Json = nlohmann::ordered_json;

Json json_of(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

/// Pose and sizes of a shape.
class DescribeFields {
 public:
  explicit DescribeFields(const ObstacleSpelling& spelling) : spelling_(spelling) {}

  Json operator()(const Sphere& s) const {
    return {{spelling_.position, json_of(s.center)}, {"radius", s.radius}};
  }
  Json operator()(const Box& s) const {
    return posed(s.pose, {{"size", json_of(2.0 * s.half_extents)}});
  }
  Json operator()(const Cylinder& s) const {
    return posed(s.pose, {{"radius", s.radius}, {"length", s.length}});
  }
  Json operator()(const Capsule& s) const {
    return {{"a", json_of(s.a)}, {"b", json_of(s.b)}, {"radius", s.radius}};
  }
  template <class Part>
  Json operator()(const CompoundShape<Part>& s) const {
    Json own = Json::object();
    if (s.radius > 0) own["radius"] = s.radius;
    own[key_of(*s.parts)] = numbers_of(*s.parts);
    return posed(s.pose, own);
  }

 private:
  static const char* key_of(const Parts<CloudPoint>&) { return "points"; }
  static const char* key_of(const Parts<Triangle>&) { return "triangles"; }
  static const char* key_of(const Parts<Cube>&) { return "cubes"; }

  [[nodiscard]] Json posed(const Transform& pose, const Json& sizes) const {
    Json fields = pose_json(pose, spelling_);
    fields.update(sizes);
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

double read_size(const Input& input) {
  if (!input.is_number() || input.number() != 0) return input.positive_number();
  input.warn(std::string(kThinFault));
  return thickened(0);
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
  const QuaternionLength length = judge_length(xyzw);
  if (length == QuaternionLength::wrong) {
    input.fail(ErrorCode::parse, "expected a quaternion of length 1, got [{}]",
               fmt::join(xyzw, ", "));
  }
  if (length == QuaternionLength::tolerated) input.warn(std::string(kScaledFault));
  const auto [x, y, z, w] = xyzw;
  return rotation_from_quaternion(w, x, y, z);
}

Shape read_shape(const Input& input, const ObstacleSpelling& spelling) {
  return ShapeReader(input, spelling).read();
}

Json pose_json(const Transform& pose, const ObstacleSpelling& spelling) {
  Json fields = {{spelling.position, json_of(pose.translation)}};
  if (spelling.writes_no_rotation || pose.rotation != Eigen::Matrix3d::Identity()) {
    const Eigen::Quaterniond q(pose.rotation);
    fields[std::string(spelling.quaternion)] = spelling.is_scalar_first
                                                   ? Json{q.w(), q.x(), q.y(), q.z()}
                                                   : Json{q.x(), q.y(), q.z(), q.w()};
  }
  return fields;
}

Json shape_json(const Shape& shape, const ObstacleSpelling& spelling) {
  Json fields = {{"type", shape_name(shape)}};
  fields.update(std::visit(DescribeFields(spelling), shape));
  return fields;
}

Json obstacles_json(const Scene& scene, const ObstacleSpelling& spelling) {
  Json obstacles = Json::array();
  for (const Obstacle& obstacle : scene.obstacles) {
    for (const Shape& shape : obstacle.shapes) {
      Json fields = {{obstacle.shapes.size() == 1 ? "name" : "body", obstacle.name}};
      fields.update(shape_json(shape, spelling));
      obstacles.push_back(std::move(fields));
    }
  }
  return obstacles;
}

Json allowed_json(const Scene& scene) {
  Json pairs = Json::array();
  for (const Obstacle& obstacle : scene.obstacles) {
    for (const std::string& link : obstacle.may_touch) pairs.push_back({link, obstacle.name});
  }
  for (const EndContact& contact : scene.end_contacts) {
    pairs.push_back({{"pair", {contact.first, contact.second}}, {"at_ends", contact.stretch}});
  }
  return pairs;
}

}  // namespace mneme::internal
