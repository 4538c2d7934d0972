// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Values as YAML text.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <string_view>

namespace mneme::internal {

/// The shortest digits that read back to `value`; .inf and .nan for what is not finite.
[[nodiscard]] std::string yaml_number(double value);
/// `text` itself where that is safe, otherwise quoted. Bytes that are not UTF-8 are replaced.
[[nodiscard]] std::string yaml_string(std::string_view text);
/// On one line: "{name: table, size: [1, 2.5, 0.1]}".
[[nodiscard]] std::string yaml_flow(const nlohmann::ordered_json& value);
/// The key with one line for each item; nothing without items.
[[nodiscard]] std::string yaml_list(std::string_view key, const nlohmann::ordered_json& items);

}  // namespace mneme::internal
