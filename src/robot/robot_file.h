// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Robot descriptions as text.
#pragma once

#include <string>

#include "mneme/base.h"

namespace mneme::internal {

/// Longer descriptions are refused.
inline constexpr std::size_t kMaxRobotFileSize = std::size_t{64} << 20;

/// The whole file, or its first kMaxRobotFileSize bytes and some more.
[[nodiscard]] Result<std::string> read_robot_file(const std::string& path);

}  // namespace mneme::internal
