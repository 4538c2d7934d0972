// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Messages that quote the input, whose names and texts may be megabytes long.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <string>
#include <string_view>

namespace mneme::internal {

/// In bytes, without the place. Longer than any message that quotes short names.
constexpr std::size_t kLongestMessage = 4000;
/// In bytes, for a name within a message.
constexpr std::size_t kLongestName = 100;

/// Returns `text`, or its begin and its end with "..." between them if it has more than `most`
/// bytes. Does not cut within a character of UTF-8.
[[nodiscard]] inline std::string elided(std::string_view text, std::size_t most = kLongestMessage) {
  if (text.size() <= most) return std::string(text);
  const auto is_within_character = [&](std::size_t at) {
    return at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80U;
  };
  std::size_t head = most - most / 3;
  std::size_t tail = text.size() - most / 3;
  while (head > 0 && is_within_character(head)) --head;
  while (is_within_character(tail)) ++tail;
  return fmt::format("{}...{}", text.substr(0, head), text.substr(tail));
}

}  // namespace mneme::internal
