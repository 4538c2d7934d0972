// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Numbers, UTF-8, fields of CSV files, costly XML, times, and names similar to a misspelt one.
#pragma once

#include <charconv>
#include <concepts>
#include <cstddef>
#include <ctime>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
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
template <std::integral Number>
std::from_chars_result number_from(const char* begin, const char* end, Number& value) {
  return std::from_chars(begin, end, value);
}
/// Returns `text` as a number, read by number_from(). Returns nothing for any other text and for
/// numbers out of range.
template <class Number>
[[nodiscard]] std::optional<Number> parse_number(std::string_view text) {
  Number number{};
  const char* const end = text.data() + text.size();
  const auto [stop, error] = number_from(text.data(), end, number);
  return error == std::errc() && stop == end ? std::optional(number) : std::nullopt;
}

/// Returns `text` as a number, infinite beyond the largest one and 0 below the least.
[[nodiscard]] std::optional<double> parse_number_or_infinity(std::string_view text);

/// Returns `text` with %20 and other codes of URLs as the bytes that they stand for. A % before
/// anything else stands for itself.
[[nodiscard]] std::string percent_decoded(std::string_view text);
/// Returns the words of `text` between spaces, tabs and line breaks, as views.
[[nodiscard]] std::vector<std::string_view> split_words(std::string_view text);
/// Returns `text` without spaces, tabs and line breaks at its ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// Returns a field of a CSV file (RFC 4180), quoted if necessary.
[[nodiscard]] std::string escape_csv(std::string_view text);

/// Returns `text` escaped for an XML attribute in double quotes.
[[nodiscard]] std::string xml_escaped(std::string_view text);
/// Returns what tinyxml2 would take very long or very much memory for, such as "has an element with
/// more than 100 attributes", or nothing.
[[nodiscard]] std::optional<std::string> find_costly_xml(std::string_view text);

/// Returns a time in seconds since 1970 as UTC in ISO 8601, such as "2026-01-31T12:00:00Z".
[[nodiscard]] std::string utc_text(std::time_t seconds);
/// Returns utc_text() of now.
[[nodiscard]] std::string current_time();

/// Returns the number of letters to insert, delete or replace to turn `a` into `b`. Case does not
/// count.
[[nodiscard]] int edit_distance(std::string_view a, std::string_view b);
/// Returns the `count` names with the smallest edit distances to `name`, nearest first.
[[nodiscard]] std::vector<std::string> close_names(const std::string& name,
                                                   std::vector<std::string> names,
                                                   std::size_t count);

}  // namespace mneme::internal
