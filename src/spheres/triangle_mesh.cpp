// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "spheres/triangle_mesh.h"

#include "base/fail.h"
#include "base/threads.h"
#include "geometry/axis_box.h"
#include "mesh/mesh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <string>

namespace mneme::internal {
namespace {

constexpr int kSides = 48;

void add_halves(const Triangle& t, double length, TriangleMesh& result) {
  const std::array<double, 3> edges = {(t.b - t.a).norm(), (t.c - t.b).norm(), (t.a - t.c).norm()};
  const auto longest = std::ranges::max_element(edges);
  if (*longest <= length) {
    result.push_back(t);
    return;
  }
  std::array<Vec3, 3> p = {t.a, t.b, t.c};
  std::rotate(p.begin(), p.begin() + (longest - edges.begin()), p.end());
  const Vec3 middle = 0.5 * (p[0] + p[1]);
  add_halves({p[0], middle, p[2]}, length, result);
  add_halves({middle, p[1], p[2]}, length, result);
}

}  // namespace

TriangleMesh triangulate(const Box& box) {
  std::array<Vec3, 8> corners;
  for (std::size_t i = 0; i < 8; ++i) {
    const Vec3 sign((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
    corners[i] = box.pose * sign.cwiseProduct(box.half_extents);
  }
  constexpr std::array<std::array<std::size_t, 4>, 6> kFaces = {
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  TriangleMesh mesh;
  for (const auto& f : kFaces) {
    mesh.push_back({corners[f[0]], corners[f[1]], corners[f[2]]});
    mesh.push_back({corners[f[0]], corners[f[2]], corners[f[3]]});
  }
  return mesh;
}

TriangleMesh triangulate(const Cylinder& cylinder) {
  const double radius = cylinder.radius / std::cos(std::numbers::pi / kSides);
  const auto corner = [&](int side, double z) {
    const double angle = 2 * std::numbers::pi * (side % kSides) / kSides;
    return cylinder.pose * Vec3(radius * std::cos(angle), radius * std::sin(angle), z);
  };
  const double top = 0.5 * cylinder.length;
  TriangleMesh mesh;
  for (int i = 0; i < kSides; ++i) {
    const std::array<Vec3, 4> side = {corner(i, -top), corner(i + 1, -top), corner(i + 1, top),
                                      corner(i, top)};
    mesh.push_back({side[0], side[1], side[2]});
    mesh.push_back({side[0], side[2], side[3]});
    mesh.push_back({cylinder.pose * Vec3(0, 0, -top), side[1], side[0]});
    mesh.push_back({cylinder.pose * Vec3(0, 0, top), side[3], side[2]});
  }
  return mesh;
}

TriangleMesh subdivide(const TriangleMesh& mesh, double length) {
  TriangleMesh result;
  for (const Triangle& triangle : mesh) {
    poll_interrupt();
    add_halves(triangle, length, result);
  }
  return result;
}

double surface_area(const TriangleMesh& mesh) {
  double area = 0;
  for (const Triangle& triangle : mesh) area += triangle.area();
  return area;
}

namespace {

/// Metres. The search for few spheres takes longer, the more they must stick out.
constexpr double kLongest = 30;

struct Triangulate {
  Result<TriangleMesh> operator()(const Box& box) const { return triangulate(box); }
  Result<TriangleMesh> operator()(const Cylinder& cylinder) const { return triangulate(cylinder); }
  Result<TriangleMesh> operator()(const MeshFile& file) const {
    return read_triangles(file.path, file.scale, file.pose);
  }
};

/// Says why a surface cannot be approximated; empty if it can.
std::string describe_flaw(const TriangleMesh& surface) {
  const double area = surface_area(surface);
  if (!(std::isfinite(area) && area > 0)) {
    return fmt::format("has an area of {} m2, expected a surface to approximate", area);
  }
  const AxisBox bounds = box_around(surface);
  const double longest = (bounds.high - bounds.low).maxCoeff();
  if (longest <= kLongest) return {};
  return fmt::format(
      "is {:.0f} m long, expected at most {} m; one in millimetres needs a scale of 0.001", longest,
      kLongest);
}

void append(std::span<const Triangle> triangles, TriangleMesh& surface) {
  surface.insert(surface.end(), triangles.begin(), triangles.end());
}

}  // namespace

Result<TriangleMesh> link_surface(const Link& link) {
  TriangleMesh surface;
  for (const Solid& solid : link.solids) {
    poll_interrupt();
    const TriangleMesh part = MNEME_TRY(
        std::visit(Triangulate{}, solid).map_error(naming(fmt::format("link '{}'", link.name))));
    append(part, surface);
  }
  const std::string flaw = describe_flaw(surface);
  if (flaw.empty()) return surface;
  return fail(ErrorCode::invalid, "link '{}': its collision geometry {}", link.name, flaw);
}

Result<TriangleMesh> mesh_surface(const AttachedObject& object) {
  TriangleMesh surface;
  for (const MeshFile& file : object.meshes) {
    append(MNEME_TRY(read_triangles(file.path, file.scale, file.pose)), surface);
  }
  for (const Shape& shape : object.shapes) {
    const Mesh* mesh = std::get_if<Mesh>(&shape);
    if (mesh == nullptr) continue;
    for (const Triangle& t : mesh->parts->list()) {
      surface.push_back({mesh->pose * t.a, mesh->pose * t.b, mesh->pose * t.c});
    }
  }
  const std::string flaw = describe_flaw(surface);
  if (!flaw.empty()) return fail(ErrorCode::invalid, "its mesh " + flaw);
  return surface;
}

}  // namespace mneme::internal
