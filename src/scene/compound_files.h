// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Files of compound shapes: points in PLY and PCD, octrees of OctoMap (Hornung et al.,
/// DOI 10.1007/s10514-012-9321-0).
#pragma once

#include "mneme/base.h"
#include "mneme/geometry.h"
#include "mneme/scene.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

inline constexpr std::size_t kMaxCloudPoints = 4'000'000;

struct CloudFile {
  std::vector<CloudPoint> points;  ///< all finite
  std::size_t skipped = 0;         ///< points with a coordinate that is not finite
  std::vector<std::string> notes;  ///< other parts of the file that were left aside
  std::size_t size() const { return points.size() + skipped; }
};

/// Reads PLY or PCD, text or binary. Errors name `source` and the line: a missing file, no
/// fields x, y and z, too few bytes, trailing bytes of PLY, more points than
/// kMaxCloudPoints.
[[nodiscard]] Result<CloudFile> read_cloud(const std::string& path);
[[nodiscard]] Result<CloudFile> parse_cloud(std::string_view bytes, const std::string& source);

/// Limit on occupied cubes, including unknown ones that count as occupied.
inline constexpr std::size_t kMaxCubes = 2'000'000;

/// Options for reading an octree.
struct OctreeUse {
  /// Unknown space within the bounding box of all known leaves counts as occupied.
  bool is_unknown_occupied = false;
  std::size_t most_cubes = kMaxCubes;  ///< occupied ones, and unknown ones that count as such
};

struct OctreeFormat {
  bool is_binary = true;    ///< two bits per child instead of log odds
  bool is_colored = false;  ///< three bytes of colour after log odds
  double resolution = 0;    ///< metres, the edge of the smallest leaves
};

/// Returns the leaves with an occupancy of at least 0.5, if any, from OctoMap's bytes after the
/// header. Errors name `source`: too few or trailing bytes, a tree that is too deep, too many
/// leaves.
[[nodiscard]] Result<std::vector<Cube>> parse_octree_data(std::string_view bytes,
                                                          const OctreeFormat& format,
                                                          const OctreeUse& use,
                                                          const std::string& source);

/// Reads a file .bt or .ot with its header, of the types OcTree and ColorOcTree.
[[nodiscard]] Result<std::vector<Cube>> parse_octree(std::string_view bytes, const OctreeUse& use,
                                                     const std::string& source);
[[nodiscard]] Result<std::vector<Cube>> read_octree(const std::string& path, const OctreeUse& use);

}  // namespace mneme::internal
