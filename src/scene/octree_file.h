// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Octrees of OctoMap (Hornung et al., DOI 10.1007/s10514-012-9321-0), in files and in messages.
#pragma once

#include "mneme/base.h"
#include "mneme/geometry.h"

#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// Occupied cubes, and unknown ones that are taken for occupied.
inline constexpr std::size_t kMaxCubes = 2'000'000;

/// What is made of one.
struct OctreeUse {
  /// What is unknown in the box around all leaves that are known is occupied, too.
  bool is_unknown_occupied = false;
  std::size_t most_cubes = kMaxCubes;  ///< occupied ones, and unknown ones if they are
};

struct OctreeFormat {
  bool is_binary = true;    ///< two bits per child instead of log odds
  bool is_colored = false;  ///< three bytes of colour after log odds
  double resolution = 0;    ///< metres, the edge of the smallest leaves
};

/// Occupied leaves of OctoMap's bytes after the header: as likely as not, or likelier. Errors name
/// `source`: bytes that end early, go on or lie too deep; no occupied leaf; too many.
[[nodiscard]] Result<std::vector<Cube>> parse_octree_data(std::string_view bytes,
                                                          const OctreeFormat& format,
                                                          const OctreeUse& use,
                                                          const std::string& source);

/// A file .bt or .ot with its header, of the types OcTree and ColorOcTree.
[[nodiscard]] Result<std::vector<Cube>> parse_octree(std::string_view bytes, const OctreeUse& use,
                                                     const std::string& source);
[[nodiscard]] Result<std::vector<Cube>> read_octree(const std::string& path, const OctreeUse& use);

}  // namespace mneme::internal
