// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What makes shapes unfit to be checked or approximated.
#pragma once

#include "mneme/geometry.h"

#include <string>
#include <string_view>

namespace mneme::internal {

/// What is wrong with a shape, such as "has no parts", or nothing: a size that is not positive, a
/// pose that is no rotation, numbers that are not finite, a compound shape without parts.
[[nodiscard]] std::string_view find_flaw(const Shape& shape);

/// "its box has no parts", of a box and "has no parts".
[[nodiscard]] std::string said_of(const Shape& shape, std::string_view flaw);

}  // namespace mneme::internal
