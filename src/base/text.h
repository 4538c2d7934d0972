// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Text that every engine and file format can hold, fields of CSV files, and names like one that
/// was misspelt.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

struct CodePoint {
  char32_t value = 0;
  std::size_t size = 0;  ///< bytes; 0 if there is none
};

/// The code point at the start of `text`, which is not empty: none if it is not UTF-8, or a NUL.
[[nodiscard]] CodePoint first_code_point(std::string_view text);
/// The code points of `text`, or nothing if it is not UTF-8 or holds a NUL.
[[nodiscard]] std::optional<std::u32string> decode_utf8(std::string_view text);
/// `text` with a question mark for every byte that decode_utf8 would not take.
[[nodiscard]] std::string storable_text(std::string_view text);

/// A field of a CSV file (RFC 4180), quoted where it must be.
[[nodiscard]] std::string escape_csv(std::string_view text);

/// Number of letters to insert, delete or replace to make `b` of `a`, whatever their case.
[[nodiscard]] int edit_distance(std::string_view a, std::string_view b);
/// The `count` names that take the least edits to `name`, nearest first.
[[nodiscard]] std::vector<std::string> close_names(const std::string& name,
                                                   std::vector<std::string> names,
                                                   std::size_t count);

}  // namespace mneme::internal
