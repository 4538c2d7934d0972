// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// From a URDF to the parts of a robot, and from the names of meshes in it to files.
#pragma once

#include "mneme/base.h"
#include "mneme/robot.h"

#include "robot/xml_reader.h"

#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// The directories that an environment variable lists, separated by colons.
[[nodiscard]] std::vector<std::string> directories_of_variable(const char* variable);

/// Finds the meshes of one URDF. `package://NAME/PATH` is looked for in the directories that are
/// given, then in those of ROS_PACKAGE_PATH, each of which may be the package's folder or hold it,
/// then in the folders NAME that the URDF itself is in. `file:///PATH` is absolute; other names are
/// relative to the URDF.
class MeshFinder {
 public:
  MeshFinder(const std::string& urdf_path, const std::vector<std::string>& package_paths);

  /// The path of a file that exists. The message of an error lists where it was looked for.
  [[nodiscard]] Result<std::string> find(const std::string& name) const;

 private:
  [[nodiscard]] Result<std::string> find_in_package(std::string_view name_and_path) const;

  std::string urdf_directory_;
  std::vector<std::string> package_paths_;
};

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
