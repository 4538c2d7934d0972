// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "shard.h"

#include <charconv>

#include <fmt/format.h>

namespace mneme::app {

std::optional<Fraction> parse_fraction(std::string_view text) {
  Fraction fraction;
  const char* end = text.data() + text.size();
  const auto [slash, index_error] = std::from_chars(text.data(), end, fraction.index);
  if (index_error != std::errc{} || slash == end || *slash != '/') return std::nullopt;
  const auto [rest, count_error] = std::from_chars(slash + 1, end, fraction.count);
  if (count_error != std::errc{} || rest != end) return std::nullopt;
  return fraction;
}

Result<Fraction> parse_shard(const std::string& text) {
  const std::optional<Fraction> shard = parse_fraction(text);
  if (shard && shard->count >= 1 && shard->index <= shard->count) return *shard;
  return fail(ErrorCode::invalid,
              fmt::format("'{}' is no shard; expected I/N with 0 <= I <= N, such as 1/16", text));
}

}  // namespace mneme::app
