// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/compound_fields.h"

#include "geometry/axis_box.h"
#include "geometry/mesh_file.h"
#include "scene/cloud_file.h"
#include "scene/octree_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

namespace mneme::internal {
namespace {

/// Metres. What is longer is rather given in another unit.
constexpr double kLongestLikely = 50;

/// The key `file`, which stands for the list `key`.
std::optional<Input> find_file(const Input& input, std::string_view key) {
  auto file = input.find("file");
  if (file && input.find(key)) {
    file->fail(ErrorCode::parse, fmt::format("expected either file or {}, got both", key));
  }
  return file;
}

/// The path of the key `file`, relative to the file that names it.
std::string path_of(const Input& file) {
  if (!file.is_text() || file.text().empty()) file.fail_expecting("the path of a file");
  return (std::filesystem::path(file.source()).parent_path() / file.text()).string();
}

template <class T>
T value_at(const Input& file, Result<T> result) {
  if (!result) file.fail(result.error().code, result.error().message);
  return *std::move(result);
}

double scale_of(const Input& input) {
  const auto scale = input.find("scale");
  return scale ? scale->positive_number() : 1.0;
}

template <class Part>
void warn_of_unit(const Input& file, const std::vector<Part>& parts,
                  std::vector<std::string>& warnings) {
  const AxisBox box = box_around(parts);
  const double longest = (box.high - box.low).maxCoeff();
  if (!(longest > kLongestLikely)) return;
  warnings.push_back(
      file.place(fmt::format("is {:.0f} m long; one in millimetres needs scale: 0.001", longest)));
}

/// Numbers of the list `key`, `count` for each part.
std::vector<double> list_of(const Input& input, std::string_view key, std::size_t count) {
  const Input list = input.at(key);
  const auto is_row = [](const Input& item) { return item.is_list(); };
  if (list.is_list() && std::ranges::any_of(list.items(), is_row)) {
    list.fail_expecting(fmt::format("the numbers of all parts in one list, {} for each", count));
  }
  const std::vector<double> numbers = list.numbers();
  if (numbers.empty() || numbers.size() % count != 0) {
    list.fail(ErrorCode::parse, fmt::format("expected {} numbers for each of the parts, got {}",
                                            count, numbers.size()));
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

}  // namespace

PointCloud read_points(const Input& input, std::vector<std::string>& warnings) {
  std::vector<CloudPoint> points;
  const auto file = find_file(input, "points");
  const double scale = scale_of(input);
  const auto at = [&](double x, double y, double z) {
    points.push_back({static_cast<float>(scale * x), static_cast<float>(scale * y),
                      static_cast<float>(scale * z)});
  };
  if (!file) {
    const std::vector<double> numbers = list_of(input, "points", 3);
    for (std::size_t i = 0; i < numbers.size(); i += 3) {
      at(numbers[i], numbers[i + 1], numbers[i + 2]);
    }
    return compound_of(std::move(points));
  }
  const std::string path = path_of(*file);
  const CloudFile cloud = value_at(*file, read_cloud(path));
  if (cloud.skipped > 0) {
    warnings.push_back(file->place(fmt::format("{}: {} of {} points are not finite and left out",
                                               path, cloud.skipped, cloud.size())));
  }
  points.reserve(cloud.points.size());
  for (const CloudPoint& p : cloud.points) at(p[0], p[1], p[2]);
  warn_of_unit(*file, points, warnings);
  return compound_of(std::move(points));
}

Mesh read_mesh_shape(const Input& input, std::vector<std::string>& warnings) {
  if (const auto file = find_file(input, "triangles")) {
    const Vec3 scale = Vec3::Constant(scale_of(input));
    auto triangles = value_at(*file, read_triangles(path_of(*file), scale, {}));
    warn_of_unit(*file, triangles, warnings);
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
  if (file) return compound_of(value_at(*file, read_octree(path_of(*file), {is_occupied})));
  if (unknown) unknown->fail(ErrorCode::parse, "expected a file beside it, got cubes");
  const Input list = input.at("cubes");
  const std::vector<double> n = list_of(input, "cubes", 4);
  std::vector<Cube> cubes;
  for (std::size_t i = 0; i < n.size(); i += 4) {
    if (!(n[i + 3] > 0)) list.fail_expecting("edges above 0");
    cubes.push_back({Vec3(n[i], n[i + 1], n[i + 2]), 0.5 * n[i + 3]});
  }
  return compound_of(std::move(cubes));
}

namespace {

void append(const Vec3& p, std::vector<double>& numbers) {
  numbers.insert(numbers.end(), {p.x(), p.y(), p.z()});
}

}  // namespace

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

}  // namespace mneme::internal
