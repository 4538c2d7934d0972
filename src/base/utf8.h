// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Text that every engine and file format can hold.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace mneme::internal {

struct CodePoint {
  char32_t value = 0;
  std::size_t size = 0;  ///< bytes; 0 if there is none
};

/// The code point at the start of `text`, which is not empty: none if it is not UTF-8, or a NUL.
[[nodiscard]] CodePoint first_code_point(std::string_view text);
/// The code points of `text`, or nothing if it is not UTF-8 or holds a NUL.
[[nodiscard]] std::optional<std::u32string> decode_utf8(std::string_view text);
/// The inverse; nothing if `points` holds a NUL or what is no code point.
[[nodiscard]] std::optional<std::string> encode_utf8(std::u32string_view points);
/// `text` with a question mark for every byte that decode_utf8 would not take.
[[nodiscard]] std::string storable_text(std::string_view text);

}  // namespace mneme::internal
