// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Files as text, and directories of what is installed.
#pragma once

#include "mneme/base.h"

#include <cstddef>
#include <filesystem>
#include <string>

namespace mneme::internal {

inline constexpr std::size_t kMaxFileBytes = std::size_t{256} << 20;

/// The bytes of the file `path`, which may have at most `max_bytes`.
[[nodiscard]] Result<std::string> read_text_file(const std::string& path,
                                                 std::size_t max_bytes = kMaxFileBytes);

/// share/mneme of the prefix that `file` is installed under: the directory that holds the innermost
/// bin or lib on its path. Empty if there is none, or if the path is relative.
[[nodiscard]] std::filesystem::path shared_data_of(const std::filesystem::path& file);

/// Where to keep what can be computed again: $XDG_CACHE_HOME/mneme or ~/.cache/mneme, which may not
/// exist yet. Empty if there is neither.
[[nodiscard]] std::string cache_directory();

}  // namespace mneme::internal
