// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace mneme::internal {

/// A field of a CSV file (RFC 4180), quoted where it must be.
[[nodiscard]] std::string escape_csv(std::string_view text);

}  // namespace mneme::internal
