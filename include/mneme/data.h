// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Where the robots and scenes are that came with mneme.
#pragma once

#include <string>
#include <vector>

#include "mneme/base.h"

namespace mneme {

/// The directories that hold robots/ and scenes/, best first: share/mneme of the installation that
/// this code is part of, that of the running program, the source tree, share/mneme of the prefix
/// that mneme was configured for, and those of XDG_DATA_DIRS. Only those that exist.
[[nodiscard]] std::vector<std::string> data_directories();

/// The file of a scene or problem that came with mneme, such as "planar/threaded_b2.yaml".
[[nodiscard]] Result<std::string> find_scene(const std::string& name);

}  // namespace mneme
