// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The frame of every HTML page: light and dark, nothing from elsewhere.
#pragma once

#include <string>
#include <string_view>

namespace mneme::internal {

/// The page up to its heading; `rules` are added to the style.
[[nodiscard]] std::string page_begin(const std::string& title, std::string_view rules);
[[nodiscard]] std::string page_end();

}  // namespace mneme::internal
