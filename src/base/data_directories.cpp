// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/base.h"

#include "base/installation.h"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <utility>

namespace mneme {
namespace {

namespace fs = std::filesystem;

/// The shared library or program that this code is linked into.
fs::path own_file() {
  Dl_info info = {};
  const bool is_known =
      dladdr(reinterpret_cast<const void*>(&internal::shared_data_of), &info) != 0;
  return is_known && info.dli_fname != nullptr ? info.dli_fname : "";
}

fs::path program_file() {
  std::error_code ignored;
  return fs::read_symlink("/proc/self/exe", ignored);
}

std::vector<fs::path> system_data() {
  const char* variable = std::getenv("XDG_DATA_DIRS");
  std::istringstream list(variable == nullptr || *variable == '\0' ? "/usr/local/share:/usr/share"
                                                                   : variable);
  std::vector<fs::path> directories;
  for (std::string directory; std::getline(list, directory, ':');) {
    if (fs::path(directory).is_absolute()) directories.push_back(fs::path(directory) / "mneme");
  }
  return directories;
}

}  // namespace

std::vector<std::string> data_directories() {
  std::vector<fs::path> candidates = {internal::shared_data_of(own_file()),
                                      internal::shared_data_of(program_file()),
                                      MNEME_SOURCE_DIRECTORY, MNEME_DATA_DIRECTORY};
  for (fs::path& directory : system_data()) candidates.push_back(std::move(directory));
  std::vector<std::string> directories;
  for (const fs::path& candidate : candidates) {
    std::error_code ignored;
    if (candidate.empty() || !fs::is_directory(candidate / "robots", ignored)) continue;
    const bool is_known =
        std::find(directories.begin(), directories.end(), candidate.string()) != directories.end();
    if (!is_known) directories.push_back(candidate.string());
  }
  return directories;
}

}  // namespace mneme
