// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// From the name of a mesh in a URDF to a file.
#pragma once

#include "mneme/base.h"

#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

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

}  // namespace mneme::internal
