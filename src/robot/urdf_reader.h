// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Reads URDF, and finds the files of meshes.
#pragma once

#include "mneme/base.h"
#include "mneme/robot.h"

#include "robot/xml_reader.h"

#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// Finds the meshes of one URDF. Searches `package://NAME/PATH` in the given directories, then in
/// those of ROS_PACKAGE_PATH: each is the package's folder or contains it. Last come the folders
/// NAME above the URDF. `file:///PATH` is absolute; other names are relative to the URDF.
class MeshFinder {
 public:
  MeshFinder(const std::string& urdf_path, const std::vector<std::string>& package_paths);

  /// Returns the path of an existing file. The error lists the paths that were tried.
  [[nodiscard]] Result<std::string> find(const std::string& name) const;

 private:
  [[nodiscard]] Result<std::string> find_in_package(std::string_view name_and_path) const;

  std::string urdf_directory_;
  std::vector<std::string> package_paths_;
};

/// Returns the pose of the child <origin> of `element`; the identity without one.
[[nodiscard]] Transform read_origin(XmlReader& xml, const XmlElement& element);

/// Adds the shape or solid of a <collision> to `link`.
void read_collision(XmlReader& xml, const MeshFinder& meshes, const XmlElement& element,
                    Link& link);

/// Returns links and joints, checked and in tree order. `source` names the text in messages; meshes
/// are relative to it.
[[nodiscard]] Result<Robot::Parts> read_urdf(std::string_view urdf, const std::string& source,
                                             const std::vector<std::string>& package_paths);

}  // namespace mneme::internal
