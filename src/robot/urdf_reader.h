// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// From URDF text to the parts of a robot.
#pragma once

#include "mneme/robot.h"

#include "robot/mesh_finder.h"
#include "robot/xml_reader.h"

#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// The pose that the child <origin> of `element` gives; the identity without one.
[[nodiscard]] Transform read_origin(XmlReader& xml, const XmlElement& element);

/// Adds the shape or solid of a <collision> to `link`.
void read_collision(XmlReader& xml, const MeshFinder& meshes, const XmlElement& element,
                    Link& link);

/// The links and joints, checked and in tree order. `source` names the text in messages; meshes are
/// relative to it.
[[nodiscard]] Result<Robot::Parts> read_urdf(std::string_view urdf, const std::string& source,
                                             const std::vector<std::string>& package_paths);

}  // namespace mneme::internal
