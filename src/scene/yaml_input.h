// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// YAML text as a tree of input values.
#pragma once

#include <string>
#include <string_view>

#include "scene/input.h"

namespace mneme::internal {

/// The one document of `yaml`; `source` names it in messages. Throws InputFailure, also for a
/// doubled key and for aliases that expand to more than a few million values.
[[nodiscard]] InputValue parse_yaml(std::string_view yaml, const std::string& source);

}  // namespace mneme::internal
