// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/base.h"

#include "base/fail.h"
#include "base/files.h"

#include <dlfcn.h>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <utility>

namespace mneme::internal {

std::filesystem::path shared_data_of(const std::filesystem::path& file) {
  if (!file.is_absolute()) return {};
  for (std::filesystem::path at = file.parent_path(); at != at.root_path(); at = at.parent_path()) {
    if (at.filename() == "bin" || at.filename() == "lib") {
      return at.parent_path() / "share" / "mneme";
    }
  }
  return {};
}

std::string cache_directory() {
  const auto absolute = [](const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr && *value == '/' ? std::string(value) : std::string();
  };
  if (const std::string cache = absolute("XDG_CACHE_HOME"); !cache.empty()) return cache + "/mneme";
  const std::string home = absolute("HOME");
  return home.empty() ? "" : home + "/.cache/mneme";
}

std::vector<std::string> directories_of_variable(const char* variable) {
  std::vector<std::string> directories;
  const char* value = std::getenv(variable);
  std::istringstream list(value == nullptr ? "" : value);
  for (std::string directory; std::getline(list, directory, ':');) {
    if (!directory.empty()) directories.push_back(directory);
  }
  return directories;
}

}  // namespace mneme::internal

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
  std::vector<std::string> listed = internal::directories_of_variable("XDG_DATA_DIRS");
  if (listed.empty()) listed = {"/usr/local/share", "/usr/share"};
  std::vector<fs::path> directories;
  for (const fs::path directory : listed) {
    if (directory.is_absolute()) directories.push_back(directory / "mneme");
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

Result<std::string> find_scene(const std::string& name) {
  std::string tried;
  for (const std::string& directory : data_directories()) {
    std::string path = directory + "/scenes/" + name;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(path, ignored)) return path;
    tried += (tried.empty() ? "" : ", ") + directory + "/scenes";
  }
  return fail(
      ErrorCode::io, "there is no scene '{}' in {}", name,
      tried.empty() ? "share/mneme/scenes: the installation of mneme is incomplete" : tried);
}

std::string_view version() { return MNEME_VERSION; }

}  // namespace mneme
