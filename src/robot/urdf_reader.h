// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Reads URDF.
#pragma once

#include "mneme/base.h"
#include "mneme/robot.h"

#include "input/xml_reader.h"
#include "mesh/mesh_finder.h"

#include <string>
#include <string_view>

namespace mneme::internal {

/// Adds the shapes of a <collision> to `link`.
void read_collision(XmlReader& xml, const MeshFinder& meshes, const XmlElement& element,
                    Link& link);

/// Returns links and joints, checked and in tree order. `source` names the text in messages; meshes
/// are relative to it.
[[nodiscard]] Result<Robot::Parts> read_urdf(std::string_view urdf, const std::string& source,
                                             const RobotOptions& options);

}  // namespace mneme::internal
