// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Finds the files of meshes that a URDF names.
#pragma once

#include "mneme/base.h"

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
  /// the URDF. Where there is no such file, backslashes count as slashes.
  [[nodiscard]] Result<std::string> find(const std::string& name,
                                         std::string* unknown = nullptr) const;

 private:
  [[nodiscard]] Result<std::string> find_named(const std::string& name, std::string* unknown) const;
  [[nodiscard]] Result<std::string> find_in_package(std::string_view name_and_path,
                                                    std::string* unknown) const;
  [[nodiscard]] const std::vector<std::string>& folders_of(const std::string& package) const;
  [[nodiscard]] const std::vector<std::string>& folders_beside(const std::string& package) const;

  std::string urdf_directory_;
  std::vector<std::string> package_paths_;  ///< given ones, then those of variables
  /// Folders of packages, as found.
  mutable std::map<std::string, std::vector<std::string>> folders_, beside_;
};

}  // namespace mneme::internal
