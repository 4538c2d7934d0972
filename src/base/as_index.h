// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace mneme::internal {

/// The indices of links and joints are int, those of containers are not.
[[nodiscard]] constexpr std::size_t as_index(int i) { return static_cast<std::size_t>(i); }

}  // namespace mneme::internal
