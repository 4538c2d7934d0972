// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace mneme::internal {

/// Where to keep what can be computed again: $XDG_CACHE_HOME/mneme or ~/.cache/mneme, which may not
/// exist yet. Empty if there is neither.
[[nodiscard]] std::string cache_directory();

}  // namespace mneme::internal
