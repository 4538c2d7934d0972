// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Collision geometry in URDF.
#pragma once

#include "mneme/robot.h"

#include "robot/mesh_finder.h"
#include "robot/xml_reader.h"

namespace mneme::internal {

/// The pose that the child <origin> of `element` gives; the identity without one.
[[nodiscard]] Transform read_origin(XmlReader& xml, const XmlElement& element);

/// Adds the shape or solid of a <collision> to `link`.
void read_collision(XmlReader& xml, const MeshFinder& meshes, const XmlElement& element,
                    Link& link);

}  // namespace mneme::internal
