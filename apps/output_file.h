// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Files that the program writes: a reader sees the old file or the whole new one.
#pragma once

#include <string>
#include <string_view>

#include "mneme/base.h"

namespace mneme::app {

/// Writes `text` to a temporary file beside `path` and renames it. Errors name `path`;
/// a memory is never written over.
[[nodiscard]] Result<void> write_file(const std::string& path, std::string_view text);

/// Makes a directory and those above it, if they are missing. Errors name `path`.
[[nodiscard]] Result<void> make_directory(const std::string& path);

}  // namespace mneme::app
