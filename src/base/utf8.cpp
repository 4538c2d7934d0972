// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/utf8.h"

#include <array>
#include <cstdint>

namespace mneme::internal {
namespace {

constexpr char32_t kLargest = 0x10ffff;

bool is_code_point(char32_t point) {
  return point != 0 && point <= kLargest && (point < 0xd800 || point > 0xdfff);
}

void append_utf8(std::string& text, char32_t point) {
  const auto byte = [&](char32_t bits) { text += static_cast<char>(bits); };
  if (point < 0x80) return byte(point);
  if (point < 0x800) {
    byte(0xc0 | (point >> 6));
  } else if (point < 0x10000) {
    byte(0xe0 | (point >> 12));
    byte(0x80 | ((point >> 6) & 0x3f));
  } else {
    byte(0xf0 | (point >> 18));
    byte(0x80 | ((point >> 12) & 0x3f));
    byte(0x80 | ((point >> 6) & 0x3f));
  }
  byte(0x80 | (point & 0x3f));
}

}  // namespace

CodePoint first_code_point(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text[0]);
  if (lead < 0x80) return {lead, lead == 0 ? std::size_t{0} : std::size_t{1}};
  const std::size_t size = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (lead < 0xc2 || lead > 0xf4 || text.size() < size) return {};
  char32_t value = lead & (0x7fU >> size);
  for (std::size_t i = 1; i < size; ++i) {
    const auto next = static_cast<unsigned char>(text[i]);
    if ((next & 0xc0) != 0x80) return {};
    value = (value << 6) | (next & 0x3fU);
  }
  // The shortest form is the only one allowed.
  constexpr std::array<char32_t, 5> kLeast = {0, 0, 0x80, 0x800, 0x10000};
  return value >= kLeast[size] && is_code_point(value) ? CodePoint{value, size} : CodePoint{};
}

std::optional<std::u32string> decode_utf8(std::string_view text) {
  std::u32string points;
  while (!text.empty()) {
    const CodePoint point = first_code_point(text);
    if (point.size == 0) return std::nullopt;
    points += point.value;
    text.remove_prefix(point.size);
  }
  return points;
}

std::optional<std::string> encode_utf8(std::u32string_view points) {
  std::string text;
  for (const char32_t point : points) {
    if (!is_code_point(point)) return std::nullopt;
    append_utf8(text, point);
  }
  return text;
}

std::string storable_text(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::size_t size = first_code_point(text).size;
    result += size == 0 ? std::string_view("?") : text.substr(0, size);
    text.remove_prefix(size == 0 ? 1 : size);
  }
  return result;
}

}  // namespace mneme::internal
