// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/base.h"
#include "mneme/robot.h"

#include "base/fail.h"
#include "base/files.h"
#include "input/xml_reader.h"
#include "robot/srdf.h"
#include "robot/urdf_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
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

Result<Robot> make_from(Robot::Parts parts, const std::string& source,
                        const RobotOptions& options) {
  return make_robot(std::move(parts), options).map_error(internal::naming(source));
}

}  // namespace

Result<Robot::Parts> parse_robot_parts(std::string_view urdf, const std::string& source,
                                       const RobotOptions& options) {
  Robot::Parts parts = MNEME_TRY(internal::read_urdf(urdf, source, options));
  if (options.srdf_path.empty()) return parts;
  const std::string srdf =
      MNEME_TRY(internal::read_text_file(options.srdf_path, internal::kMaxRobotTextSize));
  MNEME_TRY(internal::apply_srdf(srdf, options.srdf_path, parts, options.strict));
  return parts;
}

Result<Robot::Parts> read_robot(const std::string& path, const RobotOptions& options) {
  const std::string urdf = MNEME_TRY(internal::read_text_file(path, internal::kMaxRobotTextSize));
  RobotOptions with_srdf = options;
  if (options.srdf_path.empty()) with_srdf.srdf_path = find_srdf(path);
  return parse_robot_parts(urdf, path, with_srdf);
}

Result<Robot> parse_robot(std::string_view urdf, const std::string& source,
                          const RobotOptions& options) {
  Robot::Parts parts = MNEME_TRY(parse_robot_parts(urdf, source, options));
  return make_from(std::move(parts), source, options);
}

Result<Robot> load_robot(const std::string& path, const RobotOptions& options) {
  Robot::Parts parts = MNEME_TRY(read_robot(path, options));
  return make_from(std::move(parts), path, options);
}

namespace {

constexpr std::string_view kExtension = ".urdf";

/// The directories in which robots are looked for, in this order.
std::vector<std::string> search_directories() {
  std::vector<std::string> directories = internal::directories_of_variable("MNEME_ROBOT_PATH");
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
  if (name.empty()) return fail(ErrorCode::invalid, "no robot is given: expected a URDF or a name");
  if (name.find('/') != std::string::npos) {
    return fail(ErrorCode::invalid, "'{}' is no robot's name: expected one without '/'", name);
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
  return fail(ErrorCode::io, "there is no robot '{}': no {} in {}{}", name, file, tried,
              is_here ? fmt::format("; the file here is ./{}", file) : "");
}

Result<std::string> robot_file(const std::string& robot) {
  std::error_code ignored;
  const bool is_path = robot.find('/') != std::string::npos || robot.ends_with(kExtension);
  if (is_path || std::filesystem::is_regular_file(robot, ignored)) return robot;
  return find_robot(robot);
}

}  // namespace mneme
