// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What may not be written over: memories, and whatever the same command reads.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mneme/base.h"

namespace mneme::app {

/// A file that a command reads.
struct ReadFile {
  std::string_view what;  ///< "the problem"
  std::string path;       ///< also FILE.json#NAME and SCENE.yaml,REQUEST.yaml
};
/// What a robot is read from: its URDF, and `srdf` or the SRDF beside it.
[[nodiscard]] std::vector<ReadFile> robot_files(const std::string& urdf, const std::string& srdf);

/// Error: invalid, if one of `outputs` (empty ones do not count) is one of `inputs` under whatever
/// name, another output too, or a memory.
[[nodiscard]] Result<void> check_outputs(std::span<const std::string> outputs,
                                         std::span<const ReadFile> inputs);
/// Error: invalid, if `path` is a memory, sound or not.
[[nodiscard]] Result<void> refuse_memory(const std::string& path);

}  // namespace mneme::app
