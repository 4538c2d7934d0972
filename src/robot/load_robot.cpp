// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/robot.h"

#include <filesystem>

#include <fmt/format.h>

#include "base/text_file.h"
#include "robot/srdf.h"
#include "robot/urdf_reader.h"
#include "robot/xml_reader.h"

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

}  // namespace mneme
