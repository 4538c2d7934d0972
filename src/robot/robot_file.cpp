// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/robot_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>

#include <fmt/format.h>

namespace mneme::internal {

Result<std::string> read_robot_file(const std::string& path) {
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::string text;
  std::string block(std::size_t{1} << 16, '\0');
  while (file && text.size() <= kMaxRobotFileSize) {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    text.append(block.data(), static_cast<std::size_t>(file.gcount()));
  }
  if (file.bad() || !file.is_open()) {
    return fail(ErrorCode::io, fmt::format("{}: cannot be read: {}", path,
                                           errno != 0 ? std::strerror(errno) : "input error"));
  }
  return text;
}

}  // namespace mneme::internal
