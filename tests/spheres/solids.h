// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Surfaces and mesh files for the tests of this room.
#pragma once

#include "spheres/triangle_mesh.h"
#include "support/support.h"

#include <fmt/format.h>

#include <cstring>
#include <string>

namespace mneme::test {

inline Box make_box(const Vec3& extents, const Vec3& center = Vec3::Zero()) {
  return {{Eigen::Matrix3d::Identity(), center}, 0.5 * extents};
}

inline internal::TriangleMesh joined(const internal::TriangleMesh& a,
                                     const internal::TriangleMesh& b) {
  internal::TriangleMesh both = a;
  both.insert(both.end(), b.begin(), b.end());
  return both;
}

/// A cylinder about z without its flat ends.
inline internal::TriangleMesh make_tube(double radius, double length) {
  internal::TriangleMesh tube = internal::triangulate(Cylinder{{}, radius, length});
  std::erase_if(tube, [](const Triangle& t) { return t.a.z() == t.b.z() && t.b.z() == t.c.z(); });
  return tube;
}

inline Vec3 random_point(Rng& rng, double reach) {
  const double x = rng.uniform(-reach, reach);
  const double y = rng.uniform(-reach, reach);
  return {x, y, rng.uniform(-reach, reach)};
}

inline bool is_held(const Vec3& point, const std::vector<Sphere>& spheres) {
  return std::ranges::any_of(
      spheres, [&](const Sphere& s) { return (point - s.center).norm() <= s.radius + 1e-9; });
}

inline std::string to_text_stl(const internal::TriangleMesh& mesh) {
  std::string text = "solid s\n";
  for (const Triangle& t : mesh) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const Vec3& p : {t.a, t.b, t.c})
      text += fmt::format("vertex {} {} {}\n", p.x(), p.y(), p.z());
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid s\n";
}

inline std::string to_binary_stl(const internal::TriangleMesh& mesh) {
  std::string bytes(80, ' ');
  const auto add = [&](auto value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    bytes.append(raw, sizeof value);
  };
  add(static_cast<std::uint32_t>(mesh.size()));
  for (const Triangle& t : mesh) {
    for (const Vec3& p : {Vec3(0, 0, 0), t.a, t.b, t.c}) {
      for (int i = 0; i < 3; ++i) add(static_cast<float>(p[i]));
    }
    add(std::uint16_t{0});
  }
  return bytes;
}

}  // namespace mneme::test
