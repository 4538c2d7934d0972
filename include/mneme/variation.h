// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Random scenes like a given one, to learn for a workcell that is never quite the same.
#pragma once

#include <string>
#include <vector>

#include "mneme/base.h"
#include "mneme/scene.h"

namespace mneme {

/// Random numbers, one per entry: uniform within plus and minus the entry, or normal with the entry
/// as standard deviation. Without entries nothing varies.
struct Spread {
  std::vector<double> values;
  bool is_gaussian = false;
};

/// What varies about an obstacle, or about the scene as a whole.
struct Variation {
  /// The name of the obstacles meant, `*` standing for any characters; not of the whole scene.
  std::string name;
  Spread position;  ///< x, y, z, metres
  Spread rpy;       ///< radians, about fixed axes through the obstacle's middle or `center`
  Spread scale;     ///< one number, added to the factor 1 of all lengths, about the same point
  /// Metres, of an obstacle of one shape: full extents of a box; radius and length of a cylinder or
  /// capsule; radius of a sphere. Not of the whole scene.
  Spread size;
  Vec3 center = Vec3::Zero();  ///< of the whole scene only
};
struct Variations {
  Variation scene;                   ///< applied last
  std::vector<Variation> obstacles;  ///< each obstacle may be meant once
};
/// Reads a file of variations (docs/file_formats.md); strict, errors name file, line and key.
[[nodiscard]] Result<Variations> load_variations(const std::string& path);
/// A random scene like `scene`. Sizes are drawn again until they are positive. Errors: a name that
/// no obstacle has, or one that is meant twice; numbers that the obstacle's shape has no use for; a
/// spread that leaves no positive size.
[[nodiscard]] Result<Scene> vary(const Scene& scene, const Variations& variations, Rng& rng);

}  // namespace mneme
