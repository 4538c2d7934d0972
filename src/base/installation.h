// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What is installed where, and where to keep what can be computed again.
#pragma once

#include <filesystem>
#include <string>

namespace mneme::internal {

/// share/mneme of the prefix that `file` is installed under: the directory that holds the innermost
/// bin or lib on its path. Empty if there is none, or if the path is relative.
[[nodiscard]] std::filesystem::path shared_data_of(const std::filesystem::path& file);

/// Where to keep what can be computed again: $XDG_CACHE_HOME/mneme or ~/.cache/mneme, which may not
/// exist yet. Empty if there is neither.
[[nodiscard]] std::string cache_directory();

}  // namespace mneme::internal
