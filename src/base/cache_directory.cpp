// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/cache_directory.h"

#include <cstdlib>

namespace mneme::internal {

std::string cache_directory() {
  const auto absolute = [](const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr && *value == '/' ? std::string(value) : std::string();
  };
  if (const std::string cache = absolute("XDG_CACHE_HOME"); !cache.empty()) return cache + "/mneme";
  const std::string home = absolute("HOME");
  return home.empty() ? "" : home + "/.cache/mneme";
}

}  // namespace mneme::internal
