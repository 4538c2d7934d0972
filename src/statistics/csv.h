// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// How lines of CSV files (RFC 4180) are read.
#pragma once

#include <charconv>
#include <concepts>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// The fields of one line, and where the next one begins.
struct CsvRecord {
  std::vector<std::string> fields;
  std::size_t end = 0;
};
/// The line of `text` that begins at `begin`; nothing if it does not end.
[[nodiscard]] std::optional<CsvRecord> read_csv_record(std::string_view text, std::size_t begin);

/// True if all of `text` is a finite number of 0 or more, as all that we write are; it is then in
/// `value`.
template <class T>
[[nodiscard]] bool read_csv_number(std::string_view text, T& value) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end || !(value >= T{0})) return false;
  return !std::floating_point<T> || value <= std::numeric_limits<T>::max();
}

}  // namespace mneme::internal
