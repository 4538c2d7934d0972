// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace mneme::internal {

/// Converts an index of a link or joint, which is an int, to one of a container.
[[nodiscard]] constexpr std::size_t as_index(int i) { return static_cast<std::size_t>(i); }

}  // namespace mneme::internal
