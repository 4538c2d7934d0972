// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Compact text for many points, triangles and cubes: 16-bit coordinates as base64.
#pragma once

#include "mneme/geometry.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace mneme::internal {

/// Coordinates as multiples of `step` above `low`; 65535 steps span the longest extent.
struct Packed {
  std::size_t count = 0;  ///< number of points, cubes or triangles before thinning
  Vec3 low = Vec3::Zero();
  double step = 0;
  std::string data;          ///< base64 of 16-bit numbers, little-endian
  std::string indices = {};  ///< base64 of 32-bit vertex indices, three per triangle
};

[[nodiscard]] std::string to_base64(std::span<const std::uint8_t> bytes);

/// Packs x, y, z of each point. At most `most` are kept, at equal steps.
[[nodiscard]] Packed pack(const std::vector<CloudPoint>& points, std::size_t most);
/// Packs x, y, z of the centre and half the edge of each cube. At most `most` are kept, the
/// largest.
[[nodiscard]] Packed pack(const std::vector<Cube>& cubes, std::size_t most);
/// Packs vertices and triangles. Above `most` triangles, vertices in a grid cell are merged, with
/// cells that grow until enough triangles vanish (Rossignac and Borrel, Multi-resolution 3D
/// approximations for rendering complex scenes, 1993).
[[nodiscard]] Packed pack(const std::vector<Triangle>& triangles, std::size_t most);

}  // namespace mneme::internal
