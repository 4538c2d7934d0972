// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/base.h"

#include <fmt/format.h>

#include <filesystem>

namespace mneme {

Result<std::string> find_scene(const std::string& name) {
  std::string tried;
  for (const std::string& directory : data_directories()) {
    std::string path = directory + "/scenes/" + name;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(path, ignored)) return path;
    tried += (tried.empty() ? "" : ", ") + directory + "/scenes";
  }
  return fail(
      ErrorCode::io,
      fmt::format("there is no scene '{}' in {}", name,
                  tried.empty() ? "share/mneme/scenes: mneme is not installed whole" : tried));
}

}  // namespace mneme
