// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/packed.h"

#include "geometry/axis_box.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <unordered_map>

namespace mneme::internal {
namespace {

constexpr double kSteps = 65535;
/// Cells along the longest extent when vertices are first merged, and the growth of a cell.
constexpr double kFirstCells = 512;
constexpr double kCellGrowth = 1.3;

void append(std::vector<std::uint8_t>& bytes, std::uint32_t value, int size) {
  for (int i = 0; i < size; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

/// Bounds of the points and the step of their coordinates.
class Grid {
 public:
  void include(const Vec3& p) { box_.include(p); }
  [[nodiscard]] double extent() const { return std::max(1e-9, (box_.high - box_.low).maxCoeff()); }
  [[nodiscard]] double step() const { return extent() / kSteps; }
  [[nodiscard]] const Vec3& low() const { return box_.low; }
  void append(std::vector<std::uint8_t>& bytes, const Vec3& p) const {
    for (int i = 0; i < 3; ++i) append_length(bytes, p[i] - box_.low[i]);
  }
  void append_length(std::vector<std::uint8_t>& bytes, double length) const {
    const double steps = std::clamp(std::round(length / step()), 0.0, kSteps);
    internal::append(bytes, static_cast<std::uint32_t>(steps), 2);
  }

 private:
  AxisBox box_;
};

using Corners = std::array<std::uint32_t, 3>;
struct Surface {
  std::vector<Vec3> points;
  std::vector<Corners> triangles;
};

/// Replaces all vertices in a cell of `cell` metres by their mean. Degenerate triangles are
/// dropped.
Surface merged(const std::vector<Triangle>& triangles, const Grid& grid, double cell) {
  struct Hash {
    std::size_t operator()(const std::array<std::int64_t, 3>& key) const {
      std::uint64_t hash = 0;
      for (const std::int64_t value : key)
        hash = (hash ^ static_cast<std::uint64_t>(value)) * 0x9e3779b97f4a7c15ULL + (hash >> 29);
      return hash;
    }
  };
  std::unordered_map<std::array<std::int64_t, 3>, std::uint32_t, Hash> cells;
  std::vector<int> counts;
  Surface surface;
  const auto corner = [&](const Vec3& p) {
    const Vec3 at = ((p - grid.low()) / cell).array().round();
    const std::array key = {std::llround(at.x()), std::llround(at.y()), std::llround(at.z())};
    const auto [found, is_new] = cells.try_emplace(
        {key[0], key[1], key[2]}, static_cast<std::uint32_t>(surface.points.size()));
    if (is_new) {
      surface.points.emplace_back(Vec3::Zero());
      counts.push_back(0);
    }
    surface.points[found->second] += p;
    ++counts[found->second];
    return found->second;
  };
  for (const Triangle& t : triangles) {
    const Corners c = {corner(t.a), corner(t.b), corner(t.c)};
    if (c[0] != c[1] && c[1] != c[2] && c[2] != c[0]) surface.triangles.push_back(c);
  }
  for (std::size_t i = 0; i < counts.size(); ++i) surface.points[i] /= counts[i];
  return surface;
}

}  // namespace

std::string to_base64(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : kDigits[group >> (18 - 6 * k) & 63];
  }
  return text;
}

Packed pack(const std::vector<CloudPoint>& points, std::size_t most) {
  Grid grid;
  for (const CloudPoint& p : points) grid.include(to_vec3(p));
  const std::size_t stride = (points.size() + most - 1) / std::max<std::size_t>(1, most);
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < points.size(); i += std::max<std::size_t>(1, stride))
    grid.append(bytes, to_vec3(points[i]));
  return {points.size(), grid.low(), grid.step(), to_base64(bytes)};
}

Packed pack(const std::vector<Cube>& cubes, std::size_t most) {
  std::vector<Cube> shown = cubes;
  std::ranges::stable_sort(shown, std::greater(), &Cube::half_extent);
  shown.resize(std::min(shown.size(), most));
  Grid grid;
  for (const Cube& cube : shown) {
    grid.include(cube.center.array() - cube.half_extent);
    grid.include(cube.center.array() + cube.half_extent);
  }
  std::vector<std::uint8_t> bytes;
  for (const Cube& cube : shown) {
    grid.append(bytes, cube.center);
    grid.append_length(bytes, cube.half_extent);
  }
  return {cubes.size(), grid.low(), grid.step(), to_base64(bytes)};
}

Packed pack(const std::vector<Triangle>& triangles, std::size_t most) {
  Grid grid;
  for (const Triangle& t : triangles)
    for (const Vec3& p : {t.a, t.b, t.c}) grid.include(p);
  Surface surface = merged(triangles, grid, grid.step());
  double cell = grid.extent() / kFirstCells;
  for (; surface.triangles.size() > most; cell *= kCellGrowth)
    surface = merged(triangles, grid, cell);
  std::vector<std::uint8_t> points, indices;
  for (const Vec3& p : surface.points) grid.append(points, p);
  for (const Corners& corners : surface.triangles)
    for (const std::uint32_t corner : corners) append(indices, corner, 4);
  return {triangles.size(), grid.low(), grid.step(), to_base64(points), to_base64(indices)};
}

}  // namespace mneme::internal
