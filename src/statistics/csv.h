// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Reading of CSV lines (RFC 4180).
#pragma once

#include "base/text.h"

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// The fields of one line, and the offset of the next line.
struct CsvRecord {
  std::vector<std::string> fields;
  std::size_t end = 0;
};
/// The line of `text` that begins at offset `begin`; nothing if it has no end.
[[nodiscard]] std::optional<CsvRecord> read_csv_record(std::string_view text, std::size_t begin);

/// Reads `text` as a finite number of 0 or more. False for any other text.
template <class T>
[[nodiscard]] bool read_csv_number(std::string_view text, T& value) {
  const auto number = parse_number<T>(text);
  if (!number || !(*number >= T{0} && *number <= std::numeric_limits<T>::max())) return false;
  value = *number;
  return true;
}

}  // namespace mneme::internal
