// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// YAML text as a tree of input values, and values as YAML text.
#pragma once

#include "scene/input.h"

#include <span>
#include <string>
#include <string_view>

namespace mneme::internal {

/// The one document of `yaml`; `source` names it in messages. Throws InputFailure, also for a
/// doubled key and for aliases that expand to more than a few million values.
[[nodiscard]] InputValue parse_yaml(std::string_view yaml, const std::string& source);

/// The shortest digits that read back to `value`; .inf and .nan for what is not finite.
[[nodiscard]] std::string yaml_number(double value);
/// "[1, 2.5]"
[[nodiscard]] std::string yaml_numbers(std::span<const double> values);
/// `text` itself where that is safe, otherwise quoted. Bytes that are not UTF-8 are replaced.
[[nodiscard]] std::string yaml_string(std::string_view text);

}  // namespace mneme::internal
