// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Text made safe for XML, HTML, CSV and tables, whatever bytes it holds.
#pragma once

#include <string>
#include <string_view>

namespace mneme::internal {

/// `text` with malformed UTF-8, and characters that XML 1.0 forbids, replaced by U+FFFD.
[[nodiscard]] std::string clean_text(std::string_view text);
/// Cleaned and escaped, for the content and the quoted attributes of XML and HTML.
[[nodiscard]] std::string escape_markup(std::string_view text);
/// A field of a CSV file (RFC 4180), quoted where it must be.
[[nodiscard]] std::string escape_csv(std::string_view text);
/// Cleaned, on one line, for text tables.
[[nodiscard]] std::string single_line(std::string_view text);
/// Number of characters of well-formed UTF-8.
[[nodiscard]] int character_count(std::string_view text);
/// At most `limit` >= 1 characters of well-formed UTF-8; an ellipsis tells if some are missing.
[[nodiscard]] std::string shortened(const std::string& text, int limit);

}  // namespace mneme::internal
