// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/moveit_compounds.h"

#include "scene/moveit_messages.h"
#include "scene/octree_file.h"
#include "scene/shape_fields.h"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <array>
#include <cmath>

namespace mneme::internal {
namespace {

/// Metres, half of them.
constexpr double kPlaneWidth = 100, kPlaneThickness = 0.0005;

std::size_t read_index(const Input& input, std::size_t count) {
  const double value = input.finite_number();
  if (!(value >= 0 && value < static_cast<double>(count)) || value != std::floor(value)) {
    input.fail(ErrorCode::parse,
               fmt::format("expected the index of one of {} vertices, got {}", count, value));
  }
  return static_cast<std::size_t>(value);
}

}  // namespace

Mesh read_moveit_mesh(const Input& mesh, const Transform& pose) {
  mesh.allow_keys({"triangles", "vertices"});
  std::vector<Vec3> vertices;
  for (const Input& vertex : items_if_any(mesh, "vertices")) {
    vertices.push_back(read_moveit_point(vertex));
  }
  std::vector<Triangle> triangles;
  for (const Input& triangle : items_if_any(mesh, "triangles")) {
    const Input indices = triangle.is_map() ? triangle.at("vertex_indices") : triangle;
    static_cast<void>(indices.finite_numbers(3, "indices of vertices"));
    std::array<Vec3, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      corners[i] = vertices[read_index(indices.items()[i], vertices.size())];
    }
    triangles.push_back({corners[0], corners[1], corners[2]});
    if (triangles.back().area() <= 0) triangles.pop_back();
  }
  if (triangles.empty()) {
    mesh.fail(ErrorCode::parse, "expected a mesh with a triangle that has an area");
  }
  return {pose, std::make_shared<Parts<Triangle>>(std::move(triangles)), 0};
}

Box read_moveit_plane(const Input& plane, const Transform& pose) {
  plane.allow_keys({"coef"});
  const Input coefficients = plane.at("coef");
  const std::vector<double> c = coefficients.finite_numbers(4, "a, b, c, d of a plane");
  const Vec3 normal(c[0], c[1], c[2]);
  if (!(normal.norm() > 1e-9)) coefficients.fail_expecting("a normal that is not zero");
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), normal.normalized());
  const Transform X_SP{turn.toRotationMatrix(), -c[3] / normal.squaredNorm() * normal};
  return {pose * X_SP, Vec3(kPlaneWidth, kPlaneWidth, kPlaneThickness)};
}

std::optional<Octree> read_moveit_octomap(const Input& octomap) {
  if (!octomap.is_map()) return std::nullopt;
  const auto map = octomap.find("octomap");
  const auto data = map && map->is_map() ? map->find("data") : std::nullopt;
  if (!data || data->is_nothing()) return std::nullopt;
  std::string bytes;
  for (const double value : data->numbers()) {
    if (!(value >= -128 && value <= 255) || value != std::floor(value)) {
      data->fail_expecting("bytes");
    }
    bytes += static_cast<char>(static_cast<int>(value));
  }
  if (bytes.empty()) return std::nullopt;
  const std::string id = map->at("id").text();
  if (id != "OcTree" && id != "ColorOcTree") map->at("id").fail_expecting("OcTree or ColorOcTree");
  const OctreeFormat format{map->at("binary").boolean(), id == "ColorOcTree",
                            map->at("resolution").positive_number()};
  const auto cubes = parse_octree_data(bytes, format, {}, octomap.source());
  if (!cubes) data->fail(cubes.error().code, cubes.error().message);
  const auto origin = octomap.find("origin");
  return Octree{origin ? read_moveit_pose(*origin) : Transform{},
                std::make_shared<Parts<Cube>>(*cubes), 0};
}

}  // namespace mneme::internal
