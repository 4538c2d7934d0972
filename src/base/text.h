// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// UTF-8, fields of CSV files, costly XML, and names similar to a misspelt one.
#pragma once

#include <charconv>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

struct CodePoint {
  char32_t value = 0;
  std::size_t size = 0;  ///< in bytes; 0 for no code point
};

/// Returns the code point at the start of `text`, which is not empty. Size 0: NUL or not UTF-8.
[[nodiscard]] CodePoint first_code_point(std::string_view text);
/// Returns the code points of `text`, or nothing if it is not UTF-8 or contains NUL.
[[nodiscard]] std::optional<std::u32string> decode_utf8(std::string_view text);
/// Returns `text` with each NUL and each byte that is not UTF-8 written as in "\\xff".
[[nodiscard]] std::string escape_bytes(std::string_view text);

/// As std::from_chars(), which libc++ lacks for floating point before version 20.
std::from_chars_result number_from(const char* begin, const char* end, double& value);
inline std::from_chars_result number_from(const char* begin, const char* end, std::size_t& value) {
  return std::from_chars(begin, end, value);
}

/// Returns a field of a CSV file (RFC 4180), quoted if necessary.
[[nodiscard]] std::string escape_csv(std::string_view text);

/// Returns `text` escaped for an XML attribute in double quotes.
[[nodiscard]] std::string xml_escaped(std::string_view text);
/// Returns what tinyxml2 would take very long or very much memory for, such as "has an element with
/// more than 100 attributes", or nothing.
[[nodiscard]] std::optional<std::string> find_costly_xml(std::string_view text);

/// Returns the number of letters to insert, delete or replace to turn `a` into `b`. Case does not
/// count.
[[nodiscard]] int edit_distance(std::string_view a, std::string_view b);
/// Returns the `count` names with the smallest edit distances to `name`, nearest first.
[[nodiscard]] std::vector<std::string> close_names(const std::string& name,
                                                   std::vector<std::string> names,
                                                   std::size_t count);

}  // namespace mneme::internal
