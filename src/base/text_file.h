// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Files as text.
#pragma once

#include "mneme/base.h"

#include <cstddef>
#include <string>

namespace mneme::internal {

inline constexpr std::size_t kMaxFileBytes = std::size_t{256} << 20;

/// The bytes of the file `path`, which may have at most `max_bytes`.
[[nodiscard]] Result<std::string> read_text_file(const std::string& path,
                                                 std::size_t max_bytes = kMaxFileBytes);

}  // namespace mneme::internal
