// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Memory for what is filled at once and soon done with.
#pragma once

#include <memory_resource>

namespace mneme::internal {

/// Of large pages where the system has them: the first touch of each small page interrupts the
/// program, and to fill megabytes may take less than that.
[[nodiscard]] std::pmr::memory_resource* large_pages();

}  // namespace mneme::internal
