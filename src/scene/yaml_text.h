// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Values as YAML text that reads back to the same values.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace mneme::internal {

/// The shortest digits that read back to `value`; .inf and .nan for what is not finite.
[[nodiscard]] std::string yaml_number(double value);
/// "[1, 2.5]"
[[nodiscard]] std::string yaml_numbers(std::span<const double> values);
/// `text` itself where that is safe, otherwise quoted. Bytes that are not UTF-8 are replaced.
[[nodiscard]] std::string yaml_string(std::string_view text);

}  // namespace mneme::internal
