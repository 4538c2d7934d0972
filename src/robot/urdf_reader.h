// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Reads URDF, and finds the files of meshes.
#pragma once

#include "mneme/base.h"
#include "mneme/robot.h"

#include "robot/xml_reader.h"

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// Finds the meshes of one URDF. `package://NAME/PATH` and `model://NAME/PATH` are searched in the
/// given directories, those of ROS_PACKAGE_PATH and AMENT_PREFIX_PATH, and the folders above the
/// URDF. Each of these directories is the package's folder (by its name or its package.xml), a
/// folder of packages, or an install prefix with share/NAME. `file:///PATH` is absolute; other
/// names are relative to the URDF.
class MeshFinder {
 public:
  MeshFinder(const std::string& urdf_path, const std::vector<std::string>& package_paths);

  /// Returns the path of an existing file. The error lists the paths that were tried. With
  /// `unknown`, which receives the name, files of an unknown package may lie in three folders above
  /// the URDF.
  [[nodiscard]] Result<std::string> find(const std::string& name,
                                         std::string* unknown = nullptr) const;

 private:
  [[nodiscard]] Result<std::string> find_in_package(std::string_view name_and_path,
                                                    std::string* unknown) const;
  [[nodiscard]] const std::vector<std::string>& folders_of(const std::string& package) const;

  std::string urdf_directory_;
  std::vector<std::string> package_paths_;  ///< given ones, then those of variables
  mutable std::map<std::string, std::vector<std::string>> folders_;  ///< of packages, as found
};

/// Returns the pose of the child <origin> of `element`; the identity without one.
[[nodiscard]] Transform read_origin(XmlReader& xml, const XmlElement& element);

/// Adds the shapes of a <collision> to `link`.
void read_collision(XmlReader& xml, const MeshFinder& meshes, const XmlElement& element,
                    Link& link);

/// Returns links and joints, checked and in tree order. `source` names the text in messages; meshes
/// are relative to it.
[[nodiscard]] Result<Robot::Parts> read_urdf(std::string_view urdf, const std::string& source,
                                             const RobotOptions& options);

}  // namespace mneme::internal
