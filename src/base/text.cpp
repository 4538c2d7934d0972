// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/text.h"

#include <fmt/format.h>
#include <utf8.h>

#include <algorithm>

namespace mneme::internal {

CodePoint first_code_point(std::string_view text) {
  const char* end = text.data();
  try {
    const char32_t value = utf8::next(end, text.data() + text.size());
    return value == 0 ? CodePoint{} : CodePoint{value, static_cast<std::size_t>(end - text.data())};
  } catch (const utf8::exception&) {
    return {};
  }
}

std::optional<std::u32string> decode_utf8(std::string_view text) {
  if (text.find('\0') != text.npos || !utf8::is_valid(text)) return std::nullopt;
  return utf8::utf8to32(text);
}

std::string escape_bytes(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::size_t size = first_code_point(text).size;
    if (size == 0) {
      result += fmt::format("\\x{:02x}", static_cast<unsigned char>(text.front()));
    } else {
      result += text.substr(0, size);
    }
    text.remove_prefix(std::max<std::size_t>(size, 1));
  }
  return result;
}

std::string escape_csv(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  quoted += '"';
  return quoted;
}

}  // namespace mneme::internal
