// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What the tests of several rooms need: files, the planar arm, problems from MNEME_DATA.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <unistd.h>

#include "mneme/mneme.h"

namespace mneme::test {

/// A fresh directory that is removed with its contents.
class TemporaryDirectory {
 public:
  TemporaryDirectory() {
    std::string name = (std::filesystem::temp_directory_path() / "mneme-test-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;
  ~TemporaryDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] std::string operator/(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

inline void write_file(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

inline std::string read_file(const std::string& path) {
  std::stringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

/// A file of the repository, such as "robots/planar8.urdf".
inline std::string source_file(const std::string& name) {
  return std::string(MNEME_SOURCE_DIRECTORY) + "/" + name;
}

/// The planar arm that the paper's scenarios use.
inline Robot planar8() {
  auto robot = load_robot(source_file("robots/planar8.urdf"));
  REQUIRE_MESSAGE(robot.has_value(), (robot ? "" : robot.error().message));
  return *robot;
}

/// A file below MNEME_DATA, or nothing (with a message) if that is not set.
inline std::optional<std::string> data_file(const std::string& name) {
  const char* root = std::getenv("MNEME_DATA");
  if (root == nullptr || *root == '\0') {
    MESSAGE("skipped: MNEME_DATA is not set, so there is no " << name);
    return std::nullopt;
  }
  const std::string path = std::string(root) + "/" + name;
  if (!std::filesystem::exists(path)) {
    MESSAGE("skipped: there is no " << path);
    return std::nullopt;
  }
  return path;
}

/// A uniform random configuration.
inline Configuration random_configuration(const Robot& robot, Rng& rng) {
  Configuration q;
  for (int i = 0; i < robot.joint_count(); ++i) {
    q.push_back(rng.uniform(robot.group_joint(i).lower, robot.group_joint(i).upper));
  }
  return q;
}

}  // namespace mneme::test
