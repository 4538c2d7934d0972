// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Files that the program reads and writes. A reader of what it writes sees the old file or the
/// whole new one; memories, and whatever the same command reads, are never written over.
#pragma once

#include "mneme/report.h"

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace mneme::app {

/// The bytes of the file `path`, which may have at most `most_bytes`. Errors name `path`.
[[nodiscard]] Result<std::string> read_file(const std::string& path, std::size_t most_bytes);

/// Writes `text` to a temporary file beside `path` and renames it. Errors name `path`;
/// a memory is never written over.
[[nodiscard]] Result<void> write_file(const std::string& path, std::string_view text);

/// check_outputs(), before hours of work rather than after: also an error if an output is a
/// directory, or is in one that there is not or that may not be written.
[[nodiscard]] Result<void> check_files_to_write(std::span<const std::string> outputs,
                                                std::span<const ReadFile> inputs);

/// Makes a directory and those above it, if they are missing. Errors name `path`.
[[nodiscard]] Result<void> make_directory(const std::string& path);

}  // namespace mneme::app
