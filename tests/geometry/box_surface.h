// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The surface of a box as triangles.
#pragma once

#include "mneme/geometry.h"

#include <array>
#include <vector>

namespace mneme::test {

inline std::vector<Triangle> surface_of(const Box& box) {
  const auto corner = [&](int i) {
    const Vec3 sign((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
    return Vec3(box.pose * sign.cwiseProduct(box.half_extents));
  };
  constexpr std::array<std::array<int, 4>, 6> kFaces = {
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  std::vector<Triangle> triangles;
  for (const auto& f : kFaces) {
    triangles.push_back({corner(f[0]), corner(f[1]), corner(f[2])});
    triangles.push_back({corner(f[0]), corner(f[2]), corner(f[3])});
  }
  return triangles;
}

}  // namespace mneme::test
