// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Workspaces: named rigid obstacles of one or more shapes.
#pragma once

#include <string>
#include <vector>

#include "mneme/base.h"
#include "mneme/geometry.h"

namespace mneme {

/// A named rigid body of one or more shapes, in the frame of the robot's root link. Metres.
struct Obstacle {
  std::string name;
  std::vector<Shape> shapes;
};

/// The workspace W = {wo_1 .. wo_M} of the paper.
struct Scene {
  std::string name;
  std::vector<Obstacle> obstacles;
};

/// Reads a scene file (docs/file_formats.md). Errors name file, line and key; names of obstacles
/// must differ.
[[nodiscard]] Result<Scene> load_scene(const std::string& path);
/// The same for YAML text; `source` names it in messages.
[[nodiscard]] Result<Scene> parse_scene(std::string_view yaml, const std::string& source);
/// Text that parse_scene reads back to the same scene; only rotations may differ, by rounding.
[[nodiscard]] std::string to_yaml(const Scene& scene);

/// A planar scene: one sphere per circle, centred in the plane z = 0; rows are x, y, radius.
[[nodiscard]] Scene make_circle_scene(std::string name,
                                      const std::vector<std::array<double, 3>>& circles);

}  // namespace mneme
