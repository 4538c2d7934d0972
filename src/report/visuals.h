// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Shapes and colours of the links of a URDF.
#pragma once

#include "mneme/robot.h"

#include <string>
#include <vector>

namespace mneme::internal {

/// A visual shape, for pictures only: nothing is checked against it.
struct Visual {
  std::string link;
  Shape shape;        ///< in the link's frame
  std::string color;  ///< "#rrggbb", or empty
};

/// Returns the <visual> elements of a URDF, with meshes found as by read_robot(). Elements that
/// cannot be read are skipped.
[[nodiscard]] std::vector<Visual> read_visuals(const std::string& path,
                                               const std::vector<std::string>& package_paths);

}  // namespace mneme::internal
