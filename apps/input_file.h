// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Files that the program reads itself.
#pragma once

#include <cstddef>
#include <string>

#include "mneme/base.h"

namespace mneme::app {

/// The bytes of the file `path`, which may have at most `most_bytes`. Errors name `path`.
[[nodiscard]] Result<std::string> read_file(const std::string& path, std::size_t most_bytes);

}  // namespace mneme::app
