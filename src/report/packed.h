// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Many points, triangles and cubes in little text: coordinates in 16 bits, as base64.
#pragma once

#include "mneme/geometry.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace mneme::internal {

/// Coordinates as multiples of `step` above `low`: 65535 steps are the longest extent.
struct Packed {
  std::size_t count = 0;  ///< of what there is; not all of it needs to be in `data`
  Vec3 low = Vec3::Zero();
  double step = 0;
  std::string data;          ///< base64 of 16-bit numbers, the lower byte first
  std::string indices = {};  ///< of triangles: base64 of 32-bit numbers, three a triangle
};

[[nodiscard]] std::string to_base64(std::span<const std::uint8_t> bytes);

/// x, y, z of each; if there are more than `most`, every so many-th one.
[[nodiscard]] Packed pack(const std::vector<CloudPoint>& points, std::size_t most);
/// x, y, z of the middle and half the edge of each; if there are more than `most`, the largest.
[[nodiscard]] Packed pack(const std::vector<Cube>& cubes, std::size_t most);
/// x, y, z of corners, and the corners of each triangle. If there are more triangles than `most`,
/// corners are merged in cells that grow until there are not: after Rossignac and Borrel,
/// Multi-resolution 3D approximations for rendering complex scenes, 1993.
[[nodiscard]] Packed pack(const std::vector<Triangle>& triangles, std::size_t most);

}  // namespace mneme::internal
