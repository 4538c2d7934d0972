// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A second reader of HTTP/1.1, which knows only where requests end, by the letter of RFC 9112.
#pragma once

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::fuzz {

struct FramedRequest {
  std::size_t size = 0;  ///< bytes of head and body
  std::string body;

  bool operator==(const FramedRequest&) const = default;
};

/// Takes the text up to the next CR LF, and both; nothing if there is none or the line holds
/// another CR, LF or NUL.
inline std::optional<std::string_view> take_line(std::string_view& text) {
  const std::size_t end = text.find("\r\n");
  if (end == std::string_view::npos) return std::nullopt;
  const std::string_view line = text.substr(0, end);
  if (line.find_first_of(std::string_view("\r\n\0", 3)) != std::string_view::npos) {
    return std::nullopt;
  }
  text.remove_prefix(end + 2);
  return line;
}

inline std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

inline bool is_token(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 ||
           std::string_view("!#$%&'*+-.^_`|~").find(static_cast<char>(c)) != std::string_view::npos;
  });
}

inline std::optional<std::uint64_t> whole_number(std::string_view digits, int base) {
  std::uint64_t value = 0;
  const char* const end = digits.data() + digits.size();
  const auto [rest, error] = std::from_chars(digits.data(), end, value, base);
  if (digits.empty() || error != std::errc() || rest != end || digits.front() == '-') return {};
  return value;
}

struct FramingHeaders {
  std::vector<std::string> lengths, encodings;
};

/// Takes headers or trailers and the empty line after them.
inline std::optional<FramingHeaders> take_headers(std::string_view& text) {
  FramingHeaders found;
  while (true) {
    const auto line = take_line(text);
    if (!line) return std::nullopt;
    if (line->empty()) return found;
    const std::size_t colon = line->find(':');
    if (colon == std::string_view::npos || !is_token(line->substr(0, colon))) return std::nullopt;
    std::string name(line->substr(0, colon));
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    const std::string value(trimmed(line->substr(colon + 1)));
    if (name == "content-length") found.lengths.push_back(value);
    if (name == "transfer-encoding") found.encodings.push_back(value);
  }
}

/// Takes chunks, the last one and trailers.
inline std::optional<std::string> take_chunks(std::string_view& text) {
  std::string body;
  while (true) {
    const auto line = take_line(text);
    if (!line) return std::nullopt;
    const std::size_t digits =
        std::min(line->find_first_not_of("0123456789abcdefABCDEF"), line->size());
    const auto size = whole_number(line->substr(0, digits), 16);
    const std::string_view rest = trimmed(line->substr(digits));
    if (!size || (digits < line->size() && !rest.starts_with(';'))) return std::nullopt;
    if (*size == 0) break;
    if (*size > text.size() || !text.substr(*size).starts_with("\r\n")) return std::nullopt;
    body += text.substr(0, *size);
    text.remove_prefix(*size + 2);
  }
  return take_headers(text) ? std::optional(body) : std::nullopt;
}

/// The first request of a text; nothing if it is incomplete or its end is uncertain.
inline std::optional<FramedRequest> frame_request(std::string_view text) {
  const std::size_t whole = text.size();
  const auto first = take_line(text);
  if (!first || !(first->ends_with(" HTTP/1.1") || first->ends_with(" HTTP/1.0"))) return {};
  const auto headers = take_headers(text);
  if (!headers || headers->lengths.size() + headers->encodings.size() > 1) return std::nullopt;
  FramedRequest request;
  if (!headers->encodings.empty()) {
    std::string encoding = headers->encodings.front();
    std::transform(encoding.begin(), encoding.end(), encoding.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    if (encoding != "chunked" || !first->ends_with("1.1")) return std::nullopt;
    const auto body = take_chunks(text);
    if (!body) return std::nullopt;
    request.body = *body;
  } else if (!headers->lengths.empty()) {
    const auto length = whole_number(headers->lengths.front(), 10);
    if (!length || *length > text.size()) return std::nullopt;
    request.body = text.substr(0, *length);
    text.remove_prefix(*length);
  }
  request.size = whole - text.size();
  return request;
}

}  // namespace mneme::fuzz
