// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Primitives of problems as text.
#pragma once

#include "mneme/memory.h"
#include "mneme/scene.h"

#include <string>
#include <string_view>

namespace mneme::app {

/// "a and b", or "query to goal 1" for a whole query, which has no obstacles, and `index` 0.
[[nodiscard]] std::string describe(const Scene& scene, const LocalPrimitive& primitive,
                                   std::size_t index);
/// The unit of similarity errors.
[[nodiscard]] std::string_view unit_of_error(const LocalPrimitive& primitive);

}  // namespace mneme::app
