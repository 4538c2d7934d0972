// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// JSON text as a tree of input values.
#pragma once

#include <string>
#include <string_view>

#include "scene/input.h"

namespace mneme::internal {

/// The value of `json`, with lines; `source` names it in messages. Throws InputFailure.
[[nodiscard]] InputValue parse_json(std::string_view json, const std::string& source);

}  // namespace mneme::internal
