// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/base.h"
#include "mneme/robot.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

namespace mneme {
namespace {

constexpr std::string_view kExtension = ".urdf";

/// The directories in which robots are looked for, in this order.
std::vector<std::string> search_directories() {
  std::vector<std::string> directories;
  const char* variable = std::getenv("MNEME_ROBOT_PATH");
  std::string_view rest = variable == nullptr ? "" : variable;
  while (!rest.empty()) {
    const std::string_view directory = rest.substr(0, rest.find(':'));
    if (!directory.empty()) directories.emplace_back(directory);
    rest.remove_prefix(std::min(rest.size(), directory.size() + 1));
  }
  for (const std::string& directory : data_directories()) {
    directories.push_back(directory + "/robots");
  }
  return directories;
}

/// The robots of a directory by name, in alphabetical order.
std::vector<std::string> robot_names(const std::string& directory) {
  std::vector<std::string> names;
  std::error_code error;
  for (std::filesystem::directory_iterator at(directory, error), end; !error && at != end;
       at.increment(error)) {
    if (at->path().extension() == kExtension) names.push_back(at->path().stem().string());
  }
  std::ranges::sort(names);
  return names;
}

std::string describe(const std::string& directory) {
  const std::vector<std::string> names = robot_names(directory);
  if (names.empty()) return directory;
  return fmt::format("{} (which has {})", directory, fmt::join(names, ", "));
}

}  // namespace

Result<std::string> find_robot(const std::string& name) {
  if (name.empty() || name.find('/') != std::string::npos) {
    return fail(ErrorCode::invalid,
                fmt::format("'{}' is no robot's name: expected one without '/'", name));
  }
  const std::string file = name.ends_with(kExtension) ? name : name + std::string(kExtension);
  std::string tried;
  for (const std::string& directory : search_directories()) {
    std::string path = directory + "/" + file;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(path, ignored)) return path;
    tried += (tried.empty() ? "" : ", ") + describe(directory);
  }
  return fail(ErrorCode::io, fmt::format("there is no robot '{}': no {} in {}", name, file, tried));
}

Result<std::string> robot_file(const std::string& robot) {
  std::error_code ignored;
  const bool is_path = robot.find('/') != std::string::npos || robot.ends_with(kExtension);
  if (is_path || std::filesystem::is_regular_file(robot, ignored)) return robot;
  return find_robot(robot);
}

}  // namespace mneme
