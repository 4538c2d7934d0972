// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Files that the program reads and writes. A reader of what it writes sees the old file or the
/// whole new one; memories, and whatever the same command reads, are never written over.
#pragma once

#include "mneme/problem.h"

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::app {

/// The bytes of the file `path`, which may have at most `most_bytes`. Errors name `path`.
[[nodiscard]] Result<std::string> read_file(const std::string& path, std::size_t most_bytes);

/// Writes `text` to a temporary file beside `path` and renames it. Errors name `path`;
/// a memory is never written over.
[[nodiscard]] Result<void> write_file(const std::string& path, std::string_view text);

/// Makes a directory and those above it, if they are missing. Errors name `path`.
[[nodiscard]] Result<void> make_directory(const std::string& path);

/// A file that a command reads.
struct ReadFile {
  std::string_view what;  ///< "the memory"
  std::string path;
};
/// What a robot is read from: its URDF, and `srdf` or the SRDF beside it.
[[nodiscard]] std::vector<ReadFile> robot_files(const std::string& urdf, const std::string& srdf);
/// Adds those of a problem or a scene.
void add_files(std::string_view what, std::span<const std::string> files,
               std::vector<ReadFile>& all);
/// Adds those of a problem, as `what`, and those of its robot.
void add_problem_files(std::string_view what, const Problem& problem, const std::string& srdf,
                       std::vector<ReadFile>& all);

/// Error: invalid, if one of `outputs` (empty ones do not count) is one of `inputs` under whatever
/// name, another output too, a memory, or called as meshes, clouds and octrees are.
[[nodiscard]] Result<void> check_outputs(std::span<const std::string> outputs,
                                         std::span<const ReadFile> inputs);
/// Error: invalid, if `path` is a memory, sound or not.
[[nodiscard]] Result<void> refuse_memory(const std::string& path);

}  // namespace mneme::app
