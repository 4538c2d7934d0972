// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/base.h"
#include "mneme/robot.h"

#include "base/files.h"
#include "robot/srdf.h"
#include "robot/urdf_reader.h"
#include "robot/xml_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

namespace mneme {
namespace {

/// The SRDF beside a URDF, or nothing.
std::string find_srdf(const std::string& urdf_path) {
  const std::filesystem::path path = std::filesystem::path(urdf_path).replace_extension(".srdf");
  std::error_code ignored;
  const bool is_there = path != urdf_path && std::filesystem::is_regular_file(path, ignored);
  return is_there ? path.string() : "";
}

Result<Robot> make_from(const Result<Robot::Parts>& parts, const std::string& source,
                        const RobotOptions& options) {
  if (!parts) return tl::unexpected(parts.error());
  auto robot = make_robot(*parts, options);
  if (robot) return robot;
  return fail(robot.error().code, fmt::format("{}: {}", source, robot.error().message));
}

}  // namespace

Result<Robot::Parts> parse_robot_parts(std::string_view urdf, const std::string& source,
                                       const RobotOptions& options) {
  auto parts = internal::read_urdf(urdf, source, options.package_paths);
  if (!parts || options.srdf_path.empty()) return parts;
  const auto text = internal::read_text_file(options.srdf_path, internal::kMaxRobotTextSize);
  if (!text) return tl::unexpected(text.error());
  if (const auto fault = internal::apply_srdf(*text, options.srdf_path, *parts)) {
    return tl::unexpected(*fault);
  }
  return parts;
}

Result<Robot::Parts> read_robot(const std::string& path, const RobotOptions& options) {
  const auto text = internal::read_text_file(path, internal::kMaxRobotTextSize);
  if (!text) return tl::unexpected(text.error());
  if (!options.srdf_path.empty()) return parse_robot_parts(*text, path, options);
  RobotOptions with_srdf = options;
  with_srdf.srdf_path = find_srdf(path);
  return parse_robot_parts(*text, path, with_srdf);
}

Result<Robot> parse_robot(std::string_view urdf, const std::string& source,
                          const RobotOptions& options) {
  return make_from(parse_robot_parts(urdf, source, options), source, options);
}

Result<Robot> load_robot(const std::string& path, const RobotOptions& options) {
  return make_from(read_robot(path, options), path, options);
}

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
  if (name.empty()) return fail(ErrorCode::invalid, "expected a robot: a URDF file or a name");
  if (name.find('/') != std::string::npos) {
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
  std::error_code ignored;
  const bool is_here = std::filesystem::is_regular_file(file, ignored);
  return fail(ErrorCode::io,
              fmt::format("there is no robot '{}': no {} in {}{}", name, file, tried,
                          is_here ? fmt::format("; the file here is ./{}", file) : ""));
}

Result<std::string> robot_file(const std::string& robot) {
  std::error_code ignored;
  const bool is_path = robot.find('/') != std::string::npos || robot.ends_with(kExtension);
  if (is_path || std::filesystem::is_regular_file(robot, ignored)) return robot;
  return find_robot(robot);
}

}  // namespace mneme
